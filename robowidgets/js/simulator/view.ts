import { copyOf, toBytes } from "../shared/bytes.ts";
import { Canvas } from "../shared/canvas.ts";
import { Card } from "../shared/card.ts";
import { isDragged, make, makeButton, pointIn, set, setText } from "../shared/dom.ts";
import { isPlain, on } from "../shared/events.ts";
import {
  BELOW,
  drawFloor,
  fit,
  MARGIN,
  type Place,
  type Pose,
  type Projection,
  toFloor,
  toPixel,
} from "../shared/floor.ts";
import { toDegrees, toFixed, toMany } from "../shared/format.ts";
import { lacksKernel, type Model, NO_KERNEL, newName, onChange, setTraits } from "../shared/model.ts";
import { Pulse } from "../shared/pulse.ts";
import { join, type Member, othersOf, setFrozen, tellOthers } from "../shared/together.ts";
import { drawDrops, drawFree, drawRobot, drawThings, drawWalls } from "./draw.ts";
import { drawShapes } from "./draw_shapes.ts";
import { Edits } from "./edits.ts";
import { boundsOf, draggedTo, movedBy, poseOf, type Scene, type Thing, thingAt, toScene, toWalls } from "./scene.ts";
import type { RoomShape, SimulatorTraits } from "./traits.ts";

/** Pixels round a thing within which it is grabbed, by mouse or pen and by touch. */
const SLOP = 6;
const TOUCH_SLOP = 16;
/** Metres from the middle of the robot to an obstacle that the key puts ahead of it. */
const AHEAD = 0.9;
const RESET = "Restart the simulation: the robot and its room, variables and program";
const HINT = "drag the robot or an obstacle \u00B7 press o for another";
const FROZEN = "frozen \u00B7 press to go on";
const NOTHING = /* @__PURE__ */ new DataView(new ArrayBuffer(0));

interface Drag {
  thing: Thing;
  pointer: number;
  /** The place at which it was grabbed, on the floor. */
  from: Place;
  before: Pose;
  hasMoved: boolean;
}

/** A simulated robot in its room, from above. Python has the room; moves by the user are sent to it. */
export class SimulatorView implements Member {
  /** It keeps no pictures to step back to. */
  readonly oldest = -Infinity;
  readonly #model: Model<SimulatorTraits>;
  readonly #card: Card;
  readonly #edits: Edits;
  readonly #canvas: Canvas;
  readonly #pose = make("span", "");
  readonly #pointed = make("span", "rw-pointed-place");
  readonly #put: HTMLButtonElement;
  readonly #remove: HTMLButtonElement;
  readonly #reset: HTMLButtonElement;
  readonly #tell = () => this.#updateText();
  readonly #pulse: Pulse<SimulatorTraits>;
  #scene: Scene | null;
  #shapes: RoomShape[];
  #walls: Float32Array;
  #drops: Float32Array;
  #projection: Projection | null = null;
  #selected: Thing = "robot";
  #drag: Drag | null = null;
  #pointer: Place | null = null;

  constructor(model: Model<SimulatorTraits>, element: HTMLElement, signal: AbortSignal) {
    this.#model = model;
    this.#scene = toScene(this.#bytes);
    this.#shapes = model.get("_shapes");
    this.#walls = toWalls(model.get("_walls"));
    this.#drops = toWalls(model.get("_drops"));
    this.#card = new Card(element, "simulator", model, () => this.#draw(), signal);
    const { picture, controls, footer } = this.#card;
    this.#canvas = new Canvas(picture);
    this.#edits = new Edits(model, newName(), (why) => this.#onRefused(why), signal);
    this.#put = makeButton("", "Put an obstacle: press, then press a place", () => this.#onPut(), signal, "Obstacle");
    this.#put.ariaPressed = "false";
    this.#remove = makeButton("", "Remove the selected obstacle", () => this.#onRemove(), signal, "Remove");
    this.#reset = makeButton("", RESET, () => this.#onReset(), signal, "Reset");
    controls.append(this.#put, this.#remove, this.#reset);
    footer.append(this.#pose, this.#pointed);
    this.#pulse = new Pulse(
      model,
      ["_beat", "_frame"],
      () => model.get("_beat") > 0,
      () => this.#onPulse(),
      signal,
    );
    onChange(model, ["_frame"], () => this.#onFrame(), signal);
    onChange(model, ["_walls", "_drops"], () => this.#onWalls(), signal);
    onChange(model, ["_shapes"], () => this.#onShapes(), signal);
    onChange(model, ["_status"], this.#card.redraw, signal);
    onChange(model, ["paused", "_frozen_frame"], () => this.#onPaused(), signal);
    onChange(model, ["_together"], () => tellOthers(this), signal);
    join(this, signal);
    this.#watchInput(picture, signal);
  }

  get group(): string {
    return this.#model.get("_together");
  }

  /** The group of its feed is the robot. */
  get robot(): string {
    return this.group;
  }

  get paused(): boolean {
    return this.#model.get("paused");
  }

  freeze(): void {
    const bytes = toBytes(this.#model.get("_frame"));
    // A copy: hosts hand out views of larger buffers, and would send the whole buffer under a view.
    const frozen = bytes ? new DataView(copyOf(bytes, 0, bytes.byteLength)) : NOTHING;
    if (!this.paused) setTraits(this.#model, { _frozen_frame: frozen, paused: true });
  }

  release(): void {
    if (this.paused) setTraits(this.#model, { _frozen_frame: NOTHING, paused: false });
  }

  showAt(): void {}

  /** The frame on show: the frozen one, or the newest. */
  get #bytes(): DataView {
    const frozen = this.#model.get("_frozen_frame");
    return this.paused && toBytes(frozen) ? frozen : this.#model.get("_frame");
  }

  #onPaused(): void {
    if (this.paused) this.#cancel();
    this.#onPut(false);
    this.#shapes = this.paused ? this.#shapes : this.#model.get("_shapes");
    this.#show();
    tellOthers(this);
  }

  #onShapes(): void {
    if (this.paused) return;
    this.#shapes = this.#model.get("_shapes");
    this.#card.redraw();
  }

  #onFrame(): void {
    this.#edits.onFrame();
    if (!this.paused) this.#show();
  }

  #show(): void {
    this.#scene = toScene(this.#bytes);
    if (typeof this.#selected === "number" && !this.#shown?.obstacles[this.#selected]) this.#selected = "robot";
    this.#card.redraw();
  }

  /** Releases a dragged thing if Python falls silent. */
  #onPulse(): void {
    if (this.#pulse.silence) this.#cancel();
    this.#card.redraw();
  }

  #onWalls(): void {
    this.#walls = toWalls(this.#model.get("_walls"));
    this.#drops = toWalls(this.#model.get("_drops"));
    this.#card.redraw();
  }

  /** The scene with the edits of the user. */
  get #shown(): Scene | null {
    return this.#scene && this.#edits.apply(this.#scene);
  }

  get #isEditable(): boolean {
    return !lacksKernel(this.#model) && !this.#pulse.silence && !this.paused;
  }

  #draw(): void {
    const scene = this.#shown;
    const { words } = this.#pulse;
    const isAlone = lacksKernel(this.#model) && !words;
    const said = isAlone ? NO_KERNEL : this.#model.get("_status");
    const status = scene ? said : "waiting for the robot";
    this.#card.updateFrame(status ? [status] : [], "status");
    const { paused } = this;
    this.#card.updateSilence(paused ? FROZEN : words, !paused && words !== "");
    this.#card.root.classList.toggle("rw-frozen", paused);
    if (!scene || !this.#scene) return;
    // The scene of Python: a thing that the user moves, or has moved to an impossible place, must not move everything
    // else meanwhile.
    const bounds = boundsOf([this.#walls, this.#drops], this.#scene);
    const { picture, theme, noticeHeight: top } = this.#card;
    const [wide, high] = [bounds.east - bounds.west, bounds.north - bounds.south];
    picture.style.aspectRatio = `${50 * wide + 2 * MARGIN} / ${50 * high + MARGIN + BELOW}`;
    const { size } = this.#card;
    const projection = fit(bounds, { width: size.width, height: size.height - top }, top);
    this.#projection = projection;
    const context = this.#canvas.begin(size);
    drawFloor(context, projection, theme);
    drawFree(context, projection, scene, theme);
    drawDrops(context, projection, this.#drops, theme);
    drawWalls(context, projection, this.#walls, theme);
    const isActive = picture.matches(":focus-within, :hover") && this.#isEditable;
    const [selected, moved] = [isActive ? this.#selected : null, this.#edits.thing];
    drawThings(context, projection, scene, selected, moved, theme);
    drawShapes(context, projection, scene, this.#shapes, theme);
    drawRobot(context, projection, scene, selected, moved, theme);
    this.#card.texts.ask(this.#tell);
  }

  #updateText(): void {
    const scene = this.#shown;
    if (!scene) return;
    const { robot, obstacles, time } = scene;
    const { picture } = this.#card;
    const isEditable = this.#isEditable;
    const { west, east, south, north } = boundsOf([this.#walls, this.#drops], scene);
    this.#card.updateFacts([
      `${toFixed(east - west, 1)} \u00D7 ${toFixed(north - south, 1)} m`,
      `${toFixed(time, 1)} s`,
    ]);
    const words = `${toWords(robot)} \u00B7 ${toDegrees(robot.yaw)}`;
    setText(this.#pose, words);
    setText(this.#pointed, this.#pointer && !this.paused ? toWords(this.#pointer) : isEditable ? HINT : "");
    set(this.#put, "disabled", !isEditable);
    set(this.#reset, "disabled", !isEditable);
    set(this.#remove, "disabled", !isEditable || typeof this.#selected !== "number");
    const drops = this.#drops.length ? `, ${toMany(this.#drops.length / 4, "drop")}` : "";
    set(picture, "ariaLabel", `robot at ${words}, ${toMany(obstacles.length, "obstacle")}${drops}`);
    picture.ariaDescription =
      "n: next thing. Arrows: move it. Brackets: turn the robot. o: put an obstacle ahead. Delete: remove it.";
  }

  #onRefused(why: string): void {
    this.#card.say([why]);
    this.#card.redraw();
  }

  // Buttons

  get #isPutting(): boolean {
    return this.#put.ariaPressed === "true";
  }

  #onPut(isOn = !this.#isPutting): void {
    this.#put.ariaPressed = String(isOn);
    set(this.#card.picture.dataset, "cursor", isOn ? "put" : "");
  }

  #onRemove(): void {
    if (typeof this.#selected !== "number") return;
    this.#cancel();
    this.#edits.remove(this.#selected);
    this.#select("robot");
    this.#card.say(["obstacle removed"]);
  }

  #onReset(): void {
    this.#cancel();
    this.#edits.send({ act: "reset" });
    this.#select("robot");
    this.#card.say(["reset"]);
  }

  #select(thing: Thing): void {
    this.#selected = thing;
    this.#card.redraw();
  }

  // Pointer

  #watchInput(picture: HTMLElement, signal: AbortSignal): void {
    on(picture, "pointerdown", (event) => event.button === 0 && this.#onDown(event, pointIn(picture, event)), signal);
    on(picture, "pointermove", (event) => this.#onMove(event, pointIn(picture, event)), signal);
    on(picture, "pointerup", (event) => this.#onUp(event, pointIn(picture, event)), signal);
    on(picture, "pointercancel", () => this.#cancel(), signal);
    on(picture, "pointerleave", () => this.#onLeave(), signal);
    // A finger on a thing drags it; elsewhere it scrolls the page.
    const onTouch = (event: TouchEvent) => {
      const [touch] = event.touches;
      if (touch && event.touches.length === 1 && this.#thingAt(pointIn(picture, touch), true) !== null)
        event.preventDefault();
    };
    on(picture, "touchstart", onTouch, signal, { passive: false });
    on(this.#card.root, "keydown", (event) => this.#onKey(event), signal);
    for (const type of ["focusin", "focusout"] as const) on(picture, type, this.#card.redraw, signal);
  }

  #thingAt(point: Place, isTouch: boolean): Thing | null {
    const scene = this.#shown;
    if (!scene || !this.#projection || !this.#isEditable) return null;
    return thingAt(this.#projection, scene, point, isTouch ? TOUCH_SLOP : SLOP);
  }

  #onDown(event: PointerEvent, point: Place): void {
    const scene = this.#shown;
    // In a frozen picture things may have left their places.
    if (this.paused) {
      this.release();
      return;
    }
    if (!scene || !this.#projection || !this.#isEditable || this.#drag) return;
    if (this.#isPutting) {
      this.#edits.send({ act: "put", ...toFloor(this.#projection, point) });
      this.#onPut(false);
      return;
    }
    const thing = this.#thingAt(point, event.pointerType === "touch");
    if (thing === null) return;
    this.#select(thing === "heading" ? "robot" : thing);
    const from = toFloor(this.#projection, point);
    this.#drag = { thing, pointer: event.pointerId, from, before: poseOf(scene, thing), hasMoved: false };
    this.#card.picture.setPointerCapture(event.pointerId);
    set(this.#card.picture.dataset, "cursor", "grabbing");
  }

  #onMove({ pointerId, pointerType }: PointerEvent, point: Place): void {
    if (!this.#projection) return;
    this.#pointer = toFloor(this.#projection, point);
    const drag = this.#drag;
    if (drag && pointerId === drag.pointer) {
      drag.hasMoved ||= isDragged(toPixel(this.#projection, drag.from), point);
      if (drag.hasMoved)
        this.#edits.move(drag.thing, draggedTo(drag.before, drag.thing, drag.from, this.#pointer), true);
    } else if (pointerType !== "touch" && !this.#isPutting) {
      set(this.#card.picture.dataset, "cursor", this.#thingAt(point, false) === null ? "" : "grab");
    }
    this.#card.redraw();
  }

  #onUp({ pointerId }: PointerEvent, point: Place): void {
    const drag = this.#drag;
    if (!drag || pointerId !== drag.pointer || !this.#projection) return;
    this.#drag = null;
    set(this.#card.picture.dataset, "cursor", "");
    // A click selects, and moves nothing.
    if (drag.hasMoved) {
      const to = toFloor(this.#projection, point);
      this.#edits.move(drag.thing, draggedTo(drag.before, drag.thing, drag.from, to));
    }
    this.#card.redraw();
  }

  #onLeave(): void {
    this.#pointer = null;
    this.#card.redraw();
  }

  /** Cancels a drag; returns true if there was one. */
  #cancel(): boolean {
    const drag = this.#drag;
    if (drag) this.#edits.move(drag.thing, drag.before);
    this.#drag = null;
    this.#card.redraw();
    return drag !== null;
  }

  // Keys

  #onKey(event: KeyboardEvent): void {
    const scene = this.#shown;
    if (isPlain(event) && event.key === " " && event.target === this.#card.picture) {
      setFrozen([this, ...othersOf(this)], !this.paused);
      event.preventDefault();
      return;
    }
    if (!scene || !(isPlain(event) || event.getModifierState?.("AltGraph")) || !this.#isEditable) return;
    if (this.#takeKey(event.key, event.shiftKey, scene)) event.preventDefault();
  }

  #takeKey(key: string, isShift: boolean, scene: Scene): boolean {
    const thing = this.#selected;
    const pose = movedBy(key, isShift, poseOf(scene, thing));
    if (pose) {
      this.#edits.move(thing, pose);
      this.#card.say([`${toName(thing)} at ${toWords(pose)}`, thing === "robot" ? toDegrees(pose.yaw) : ""]);
    } else if (key === "n" || key === "p") {
      const count = scene.obstacles.length + 1;
      const next = ((typeof thing === "number" ? thing + 1 : 0) + (key === "n" ? 1 : count - 1)) % count;
      this.#select(next ? next - 1 : "robot");
      this.#card.say([`${toName(this.#selected)} at ${toWords(poseOf(scene, this.#selected))}`]);
    } else if (key === "o") {
      const { x, y, yaw } = scene.robot;
      this.#edits.send({ act: "put", x: x + AHEAD * Math.cos(yaw), y: y + AHEAD * Math.sin(yaw) });
      this.#card.say(["obstacle ahead"]);
    } else if (key === "Delete" || key === "Backspace") this.#onRemove();
    else if (key === "Escape") {
      if (!this.#cancel() && this.#isPutting) this.#onPut(false);
    } else return false;
    this.#card.redraw();
    return true;
  }
}

function toWords({ x, y }: Place): string {
  return `x ${toFixed(x, 2)} y ${toFixed(y, 2)} m`;
}

function toName(thing: Thing): string {
  return typeof thing === "number" ? `obstacle ${thing + 1}` : "robot";
}
