import { explainWords } from "./later/glossary.ts";
import { keepPictures } from "./later/saved_pictures.ts";

/** The parts of the page that no first picture needs: run_once.ts loads them a moment after the first view. */
export const LATER = { explainWords, keepPictures };

export default LATER;
