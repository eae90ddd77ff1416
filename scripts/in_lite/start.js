// The start of each page of JupyterLite: shows missing features of the browser, and the progress of loading Python. The
// kernel then loads these files from the browser's cache.
const SITE = new URL(".", import.meta.url);
const AT_ONCE = 4;

const STYLE = `
.rw-start { font: 16px/1.5 system-ui, sans-serif; font-variant-numeric: tabular-nums; color: #1b1b1b; background: #fff;
  accent-color: #1565c0; --quiet: #595959; }
.rw-start p { margin: 0; max-width: 70ch; }
.rw-loading { position: fixed; inset: 0; z-index: 2000; display: grid; place-content: center; gap: 12px; padding: 24px;
  opacity: 0; animation: rw-start 0s .4s forwards; }
.rw-loading progress { width: min(420px, calc(100vw - 48px)); height: 12px; }
.rw-loading p + progress + p { font-size: 14px; color: var(--quiet); }
.rw-cannot { position: fixed; inset: auto 0 0; z-index: 2001; display: flex; gap: 16px; align-items: start;
  justify-content: center; padding: 12px 24px; border-top: 3px solid #b26a00; }
.rw-cannot button { font: inherit; padding: 2px 12px; }
@keyframes rw-start { to { opacity: 1; } }
@media (prefers-color-scheme: dark) {
  .rw-start { color: #eee; background: #111; accent-color: #64b5f6; --quiet: #aaa; color-scheme: dark; }
}`;

/** Shows an element with the content `inner` over the page. */
function show(kind, inner) {
  const box = document.createElement("section");
  box.className = `rw-start ${kind}`;
  box.innerHTML = `<style>${STYLE}</style>${inner}`;
  document.body.append(box);
  return box;
}

/** Shows a message about missing features until the user closes it. */
function sayWhatIsMissing(words) {
  const missing = [];
  if (!("Suspending" in WebAssembly)) missing.push(words.noSwitching);
  if (!navigator.serviceWorker) missing.push(words.noFiles);
  if (!missing.length) return;
  const box = show("rw-cannot", '<p role="alert"></p><button type="button">Close</button>');
  box.querySelector("p").textContent = missing.join(" ");
  box.querySelector("button").onclick = () => box.remove();
}

/** Fetches files of known sizes, and shows the progress. */
async function load(sizes) {
  const box = show(
    "rw-loading",
    `<p></p><progress aria-label="Loading Python" value="0"></progress>
    <p>JupyterLab and Python then start, which takes some more seconds.</p>`,
  );
  const bar = box.querySelector("progress");
  const waiting = Object.keys(sizes);
  bar.max = Object.values(sizes).reduce((sum, size) => sum + size, 0);
  const add = (bytes) => {
    bar.value += bytes;
    const [loaded, all] = [bar.value, bar.max].map((count) => (count / 1e6).toFixed(1));
    box.querySelector("p").textContent = `Loading Python: ${loaded} of ${all} MB`;
  };
  const loadNext = async () => {
    for (let file = waiting.shift(); file; file = waiting.shift()) {
      const answer = await fetch(new URL(file, SITE));
      if (!answer.ok) throw new Error(`${file}: ${answer.status}`);
      const reader = answer.body.getReader();
      for (let part = await reader.read(); !part.done; part = await reader.read()) add(part.value.length);
    }
  };
  add(0);
  try {
    await Promise.all(Array.from({ length: AT_ONCE }, loadNext));
  } finally {
    box.remove();
  }
}

try {
  const { sizes, words } = await (await fetch(new URL("start.json", SITE))).json();
  if (document.readyState === "loading") {
    await new Promise((done) => document.addEventListener("DOMContentLoaded", done, { once: true }));
  }
  sayWhatIsMissing(words);
  await load(sizes);
} catch (error) {
  console.warn(`JupyterLite starts without what could not be loaded ahead: ${error}`);
}
