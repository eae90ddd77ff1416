// What a person does to a player, and when the picture of its laser says so: by the numbers that bench reads back.
window.playing = (() => {
  const PATIENCE_MS = 20_000;
  const shown = () => window.bench.read()[0];
  let pending;

  return {
    // Starts to wait for a kind of event and for the picture that is another after it.
    watch(kind) {
      const before = shown();
      let began = null;
      document.addEventListener(kind, (event) => { began = event.timeStamp; }, { capture: true, once: true });
      pending = (async () => {
        const deadline = performance.now() + PATIENCE_MS;
        for (;;) {
          await window.bench.frame();
          const at = performance.now();
          const number = shown();
          if (began !== null && number !== null && number !== before) return [at - began, number];
          if (at > deadline) throw new Error(`after ${kind} the picture still says ${number}`);
        }
      })();
    },

    // Milliseconds from the event to the end of the frame with the other picture, and the number in that.
    seen: () => pending,

    // Frames of the page a second, pictures that are others than before, and how far the numbers went.
    async count(seconds) {
      const numbers = [];
      await window.bench.frame();
      const began = performance.now();
      while (performance.now() < began + 1000 * seconds) {
        await window.bench.frame();
        numbers.push(shown());
      }
      const took = (performance.now() - began) / 1000;
      const others = numbers.filter((number, i) => i > 0 && number !== null && number !== numbers[i - 1]);
      return {
        frames: numbers.length / took,
        painted: others.length / took,
        passed: others.length ? (others.at(-1) - others[0]) / took : 0,
      };
    },
  };
})();
