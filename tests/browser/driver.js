// What the tests ask of JupyterLab inside the page, by the objects that its own extensions use.
window.driver = (() => {
  const runs = new Map();
  const watched = new WeakSet();
  const saving = new Set();
  const app = () => window.jupyterapp;
  const panelOf = (path) => [...app().shell.widgets("main")].find((widget) => widget.context?.path === path);
  const cellOf = (path, index) => panelOf(path).content.widgets.at(index);
  const kernelOf = (path) => panelOf(path).sessionContext.session?.kernel;

  return {
    // Set by a test that changes the page for good.
    isSpoilt: false,

    isLoaded: () => Boolean(app()?.commands.hasCommand("docmanager:open")),

    // Gives nothing back: Playwright would copy all of JupyterLab that its widget leads to.
    async open(path) {
      await app().commands.execute("docmanager:open", { path });
    },

    // Closes all notebooks, without the question whether to save them; false if the page cannot be used again.
    async closeAll() {
      // A page with documents beside each other opens again what was open when it was loaded.
      if (!this.isLoaded() || this.isSpoilt || app().shell.mode !== "single-document") return false;
      // What plays goes on without its view.
      for (const stop of document.querySelectorAll('.rw-play[title^="Stop here"]')) stop.click();
      // JupyterLab reports an error if a notebook is closed while it is saved, as ours do with their pictures.
      for (let i = 0; saving.size && i < 600; i++) await new Promise((done) => setTimeout(done, 100));
      if (saving.size) return false;
      for (const widget of [...app().shell.widgets("main")]) widget.dispose();
      this.slowDown(1);
      return true;
    },

    // Documents beside each other and the file browser, as JupyterLab starts where it is not in simple mode.
    showMany() {
      const { shell } = app();
      shell.mode = "multiple-document";
      shell.expandLeft();
    },

    // Has the page's clock go so many times slower.
    slowDown(times) {
      delete performance.now;
      const now = performance.now.bind(performance);
      if (times !== 1) performance.now = () => now() / times;
    },

    ready(path) {
      const panel = app() && panelOf(path);
      if (panel && !watched.has(panel.context)) {
        watched.add(panel.context);
        panel.context.saveState.connect((context, state) => {
          if (state === "started") saving.add(context);
          else saving.delete(context);
        });
      }
      const kernel = panel?.sessionContext?.session?.kernel;
      return Boolean(
        panel?.context.isReady &&
          panel.isVisible &&
          kernel?.connectionStatus === "connected" &&
          (kernel.status === "idle" || kernel.status === "busy") &&
          !document.querySelector("#jupyterlab-splash"),
      );
    },

    cells: (path) => panelOf(path).content.widgets.map((cell) => cell.model.type),

    // Marks a cell's element, so that it is found again wherever the cell moves.
    mark(path, index) {
      const cell = cellOf(path, index);
      cell.node.dataset.cell = cell.model.id;
      return cell.model.id;
    },

    // As the file has them.
    savedOutputs: (path, index) => cellOf(path, index).model.sharedModel.toJSON().outputs,

    isDirty: (path) => panelOf(path).model.dirty,

    outputs: (path, index) => cellOf(path, index).model.outputs.toJSON(),

    edit: (path, index, source) => cellOf(path, index).model.sharedModel.setSource(source),

    append(path, source) {
      const notebook = panelOf(path).content;
      notebook.model.sharedModel.addCell({ cell_type: "code", source });
      return notebook.widgets.length - 1;
    },

    start(path, index) {
      const notebook = panelOf(path).content;
      const cell = cellOf(path, index);
      const kernel = kernelOf(path);
      const run = { started: false, ended: false };
      const onMessage = (_, { header }) => {
        run.started ||= header.msg_type === "execute_input";
      };
      runs.set(cell.model.id, run);
      notebook.activeCellIndex = notebook.widgets.indexOf(cell);
      kernel.iopubMessage.connect(onMessage);
      app()
        .commands.execute("notebook:run-cell")
        .finally(() => {
          run.ended = true;
          kernel.iopubMessage.disconnect(onMessage);
        });
    },

    started(path, index) {
      const run = runs.get(cellOf(path, index).model.id);
      return run.started || run.ended;
    },

    ended: (path, index) => runs.get(cellOf(path, index).model.id).ended,

    // As the menu does, which brings no cell but the last one into view.
    runAll: () => app().commands.execute("notebook:run-all-cells"),

    // Keeps cells out of sight as this value of JupyterLab's setting does.
    setWindowing(path, windowingMode) {
      const { content } = panelOf(path);
      content.notebookConfig = { ...content.notebookConfig, windowingMode };
    },

    // Scrolls to a cell, whose place JupyterLab guesses until it has rendered what lies between; true if it is in view.
    scrollTo(path, index) {
      const { content } = panelOf(path);
      const [outer, cell] = [content.outerNode.getBoundingClientRect(), cellOf(path, index).node.getBoundingClientRect()];
      const isThere = this.isRendered(path, index) && cell.top < outer.bottom - 50 && cell.bottom > outer.top + 50;
      if (!isThere) content.scrollToItem(index, "start");
      return isThere;
    },

    // Goes to the last cell; true if a cell is so far away that its output is not rendered. With the focus or the selection
    // in it, it would be.
    scrollAway(path, index) {
      const { content } = panelOf(path);
      content.activeCellIndex = content.widgets.length - 1;
      document.activeElement?.blur();
      getSelection().removeAllRanges();
      content.outerNode.scrollTop = content.outerNode.scrollHeight;
      return !this.isRendered(path, index);
    },

    isRendered: (path, index) =>
      cellOf(path, index)
        .node.querySelector(".jp-Cell-outputArea")
        .checkVisibility({ contentVisibilityAuto: true }),

    async python(path, code) {
      const answer = { text: "", traceback: null };
      const future = kernelOf(path).requestExecute({ code, store_history: false });
      future.onIOPub = ({ header, content }) => {
        if (header.msg_type === "stream") answer.text += content.text;
        if (header.msg_type === "execute_result") answer.text += content.data["text/plain"];
        if (header.msg_type === "error") answer.traceback = content.traceback;
      };
      await future.done;
      return answer;
    },

    // As after a lost connection; until all that the kernel's widgets are has come again.
    async reconnect(path) {
      const { rendermime } = panelOf(path).content;
      const renderer = rendermime.createRenderer("application/vnd.jupyter.widget-view+json");
      const { restored } = await renderer._manager.promise;
      const isThere = new Promise((done) => restored.connect(done));
      await kernelOf(path).reconnect();
      await isThere;
      renderer.dispose();
    },

    restart: (path) => panelOf(path).sessionContext.restartKernel(),

    interrupt: (path) => kernelOf(path).interrupt(),

    save: (path) => panelOf(path).context.save(),

    async theme(name) {
      if (!this.hasTheme(name)) await app().commands.execute("apputils:change-theme", { theme: name });
    },

    // JupyterLab hides itself while it puts a theme on.
    hasTheme: (name) => app().shell.isVisible && document.body.dataset.jpThemeName === name,

    // Until all that was asked for before is drawn. Cards take turns, and one may ask for another, or change its own size.
    async drawn() {
      for (let i = 0; i < 3; i++) {
        await this.laidOut();
        const frames = window[Symbol.for("robowidgets frames")];
        await new Promise((draw) => (frames ? frames.ask({ draw, isFirst: false }) : draw()));
      }
    },

    // The page has been laid out for all that was changed before.
    laidOut: () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done()))),

    // The width that widgets get, once the window's latest size has been laid out.
    async outputWidth(path) {
      await this.laidOut();
      const { node } = panelOf(path).content;
      const shown = node.querySelector(".jp-OutputArea-output.lm-Panel") ?? node.querySelector(".jp-InputArea-editor");
      return shown.getBoundingClientRect().width;
    },
  };
})();
