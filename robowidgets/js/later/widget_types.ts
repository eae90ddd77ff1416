/** The types of widgets in the outputs and in the metadata of a notebook. */

export const WIDGET = "application/vnd.jupyter.widget-view+json";
export const STATE = "application/vnd.jupyter.widget-state+json";
/**
 * The type of a reference to a widget that no host displays. Outputs with a saved picture have it, so that a file may
 * leave out the other one.
 */
export const UNSEEN = "application/vnd.robowidgets.view+json";
