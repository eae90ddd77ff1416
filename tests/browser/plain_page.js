// The host of widgets on a page without Jupyter: models that hold what Python's widgets sent, and views of them.
// `plain_page.py` is the other end of the socket. Each message is a header in JSON, its length before it, and buffers.

// As in a page that comes over plain http, from a robot.
delete Crypto.prototype.randomUUID;

const models = new Map();
const settled = [];
const socket = new WebSocket(`ws://${location.host}/socket/${location.hash.slice(1)}`);
socket.binaryType = "arraybuffer";
const opened = new Promise((open) => {
  socket.onopen = open;
});

function post(header, buffers = []) {
  const parts = buffers.map((buffer) => new Uint8Array(buffer.buffer ?? buffer, buffer.byteOffset, buffer.byteLength));
  const text = new TextEncoder().encode(JSON.stringify({ ...header, sizes: parts.map((part) => part.byteLength) }));
  const length = new Uint8Array(4);
  new DataView(length.buffer).setUint32(0, text.length, true);
  socket.send(new Blob([length, text, ...parts]));
}

function unpack(bytes) {
  const length = new DataView(bytes).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(bytes.slice(4, 4 + length)));
  let start = 4 + length;
  const buffers = header.sizes.map((size) => {
    start += size;
    // As Jupyter does, a view into the whole message.
    return new DataView(bytes, start - size, size);
  });
  return { header, buffers };
}

function putBuffers(state, paths, buffers) {
  for (const [i, path] of paths.entries()) {
    const holder = path.slice(0, -1).reduce((inner, key) => inner[key], state);
    holder[path.at(-1)] = buffers[i];
  }
  return state;
}

const isBinary = (value) => ArrayBuffer.isView(value) || value instanceof ArrayBuffer;

function isSame(a, b) {
  return a === b || (!isBinary(a) && !isBinary(b) && JSON.stringify(a) === JSON.stringify(b));
}

class Model {
  widget_manager = { get_model: async (id) => models.get(id) };
  _state_lock = null;
  #state;
  #changed = {};
  #callbacks = new Map();

  constructor(id, state) {
    this.id = id;
    this.#state = state;
  }

  get names() {
    return Object.keys(this.#state);
  }

  get(name) {
    return this.#state[name];
  }

  set(name, value) {
    this.#changed[name] = value;
    this.#take({ [name]: value });
  }

  save_changes() {
    const state = this.#changed;
    this.#changed = {};
    if (!Object.keys(state).length) return;
    const binary = Object.keys(state).filter((name) => isBinary(state[name]));
    const plain = Object.fromEntries(Object.entries(state).filter(([name]) => !binary.includes(name)));
    const data = { method: "update", state: plain, buffer_paths: binary.map((name) => [name]) };
    post(
      { comm: this.id, data },
      binary.map((name) => state[name]),
    );
  }

  send(content, _callbacks, buffers = []) {
    post({ comm: this.id, data: { method: "custom", content } }, buffers);
  }

  on(event, callback) {
    this.#callbacks.set(event, (this.#callbacks.get(event) ?? new Set()).add(callback));
  }

  off(event, callback) {
    this.#callbacks.get(event)?.delete(callback);
  }

  set_state(state) {
    this._state_lock = state;
    this.#take(state);
    this._state_lock = null;
  }

  fire(event, ...given) {
    for (const callback of [...(this.#callbacks.get(event) ?? [])]) callback(...given);
  }

  #take(values) {
    const changed = Object.keys(values).filter((name) => !isSame(this.#state[name], values[name]));
    Object.assign(this.#state, values);
    for (const name of changed) this.fire(`change:${name}`);
  }

  /** The widget's module, loaded and initialised once, as anywidget does it. */
  get widget() {
    this.loaded ??= this.#load();
    return this.loaded;
  }

  async #load() {
    const url = URL.createObjectURL(new Blob([this.get("_esm")], { type: "text/javascript" }));
    const { default: given } = await import(url);
    URL.revokeObjectURL(url);
    const style = document.getElementById(this.get("_anywidget_id")) ?? document.createElement("style");
    style.id = this.get("_anywidget_id");
    style.textContent = this.get("_css") ?? "";
    document.head.append(style);
    const widget = typeof given === "function" ? await given() : given;
    this.ended = new AbortController();
    await widget.initialize?.({ model: this, signal: this.ended.signal });
    return widget;
  }
}

async function take(bytes) {
  const { header, buffers } = unpack(bytes);
  const { kind, comm, data } = header;
  if (kind === "settled") settled.shift()();
  else if (kind === "comm_open") {
    const model = new Model(comm, putBuffers(data.state, data.buffer_paths, buffers));
    models.set(comm, model);
    if (model.get("_esm")) await model.widget;
  } else if (kind === "comm_close") models.get(comm)?.ended?.abort();
  else if (data.method === "update") models.get(comm).set_state(putBuffers(data.state, data.buffer_paths, buffers));
  else if (data.method === "custom") models.get(comm).fire("msg:custom", data.content, buffers);
}

// One message after the other, each when the widget of the one before is there.
let taken = opened;
socket.onmessage = ({ data: bytes }) => {
  // What one message throws keeps none from those after it, and is among the errors of the console.
  taken = taken.then(() => take(bytes)).catch(reportError);
};

function outputOf(cell) {
  const found = document.querySelector(`[data-cell="${cell}"]`);
  if (found) return found;
  const output = document.createElement("div");
  output.className = "cell jp-OutputArea-output";
  output.dataset.cell = cell;
  document.body.append(output);
  return output;
}

function watchLayout(element, layout) {
  for (const name of layout.names.filter((name) => !name.startsWith("_"))) {
    const apply = () => {
      element.style[name.replace(/_(.)/g, (_, letter) => letter.toUpperCase())] = layout.get(name) ?? "";
    };
    layout.on(`change:${name}`, apply);
    apply();
  }
}

/** The part of anywidget's host that a widget needs that holds others. */
const anywidgetHost = {
  async getWidget(reference) {
    const model = models.get(reference.replace("anywidget:", ""));
    return { render: ({ el, signal }) => renderInto(model, el, signal) };
  },
};

async function renderInto(model, element, signal) {
  const widget = await model.widget;
  await widget.render({ model, el: element, host: anywidgetHost, signal });
  for (const card of element.children) card.dataset.sheet = model.get("_anywidget_id");
}

const modelOf = (reference) => models.get(reference.replace("IPY_MODEL_", ""));

/** Shows what a box holds. As in ipywidgets, from the first child on that is another one all views are new. */
async function holdChildren(element, model, ended) {
  const shown = [];
  const update = async () => {
    const names = model.get("children");
    const same = [...shown, null].findIndex((child, i) => child === null || child.name !== names[i]);
    for (const gone of shown.splice(same)) {
      gone.ended.abort();
      gone.element.remove();
    }
    for (const name of names.slice(same)) {
      const own = new AbortController();
      ended.signal.addEventListener("abort", () => own.abort());
      const child = await view(modelOf(name), own);
      shown.push({ name, element: child, ended: own });
      element.append(child);
    }
  };
  let updated = update();
  model.on("change:children", () => {
    updated = updated.then(update);
  });
  await updated;
}

/** A view of a widget, with all that it holds where it is a box; a text is shown as it is now. */
async function view(model, ended) {
  const element = document.createElement("div");
  element.className = "widget";
  element.classList.add(...(model.get("_dom_classes") ?? []));
  model.on("change:_dom_classes", () => element.classList.add(...model.get("_dom_classes")));
  watchLayout(element, modelOf(model.get("layout")));
  const kind = model.get("_model_name");
  if (kind === "HTMLModel") element.innerHTML = model.get("value");
  if (kind.endsWith("BoxModel")) {
    // As ipywidgets names them.
    element.classList.add("box", kind, ...(kind === "HBoxModel" ? ["widget-hbox"] : []));
    await holdChildren(element, model, ended);
  }
  if (!model.get("_esm")) return element;
  try {
    await renderInto(model, element, ended.signal);
  } catch (error) {
    console.error("anywidget:", error);
  }
  return element;
}

const views = new Map();

window.host = {
  /** Python has handled all that the page has sent, and the page has taken in all that Python had sent by then. */
  async settle() {
    await opened;
    return new Promise((done) => {
      settled.push(done);
      post({ settle: true });
    });
  },

  clear(cell) {
    for (const ended of views.get(cell) ?? []) ended.abort();
    views.set(cell, []);
    outputOf(cell).replaceChildren();
  },

  async show(cell, id) {
    const ended = new AbortController();
    views.get(cell).push(ended);
    outputOf(cell).append(await view(models.get(id), ended));
  },
};
