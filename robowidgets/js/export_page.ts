import { start } from "./export/page.ts";
import { explain } from "./export/parts.ts";
import laser from "./laser_widget.ts";
import { explainWords } from "./later/glossary.ts";
import path from "./path_widget.ts";
import player from "./player_widget.ts";
import scanogram from "./scanogram_widget.ts";
import screen from "./screen_widget.ts";
import speed from "./speed_widget.ts";
import touch from "./touch_widget.ts";

/** The script of a page in a file: the widgets of robowidgets by their modules, and the code that replaces Python. */
const WIDGETS = {
  laser_widget: laser,
  path_widget: path,
  player_widget: player,
  scanogram_widget: scanogram,
  screen_widget: screen,
  speed_widget: speed,
  touch_widget: touch,
};

explainWords(document);
start(WIDGETS as unknown as Parameters<typeof start>[0]).catch((error) =>
  explain(`This page cannot be shown: ${error}`),
);
