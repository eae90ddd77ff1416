/** The part of an editor of CodeMirror 6, as in the cells of JupyterLab, that is used here. */
export interface Editor {
  readonly state: { readonly doc: { toString(): string }; readonly readOnly: boolean };
  dispatch(change: { changes: Change[]; userEvent: string }): void;
}

interface Change {
  from: number;
  to: number;
  insert: string;
}

/** The element of CodeMirror that refers to its editor: `cmTile` since its version 6.39. */
type Content = Element & { cmView?: { rootView?: { view?: Editor } }; cmTile?: { root?: { view?: Editor } } };

/** Returns the editors of the page. A host that shows a widget in a frame of its own has none. */
export function editorsOf(page: ParentNode): Editor[] {
  return [...page.querySelectorAll<Content>(".cm-content")].flatMap(({ cmView, cmTile }) => {
    const editor = (cmView?.rootView ?? cmTile?.root)?.view;
    return editor ? [editor] : [];
  });
}

/**
 * Replaces lines in the one editor that has them once. Only lines that differ change.
 * @param befores the lines as they may be now, the most probable ones first
 * @returns the reason why no lines were replaced; empty if they were
 */
export function replaceIn(
  editors: readonly Editor[],
  befores: readonly (readonly string[])[],
  after: readonly string[],
): string {
  for (const before of befores) {
    const found = editors.flatMap((editor) => placesIn(editor, before).map((from) => ({ editor, from })));
    const [place] = found;
    if (!place || before.length !== after.length) continue;
    const { editor } = place;
    if (found.some((other) => other.editor !== editor)) return "more than one cell of this page contains its function";
    if (found.length > 1) return "its cell contains its function more than once";
    if (editor.state.readOnly) return "its cell is read-only";
    const changes: Change[] = [];
    let { from } = place;
    for (const [i, line] of before.entries()) {
      const insert = after[i] ?? line;
      if (insert !== line) changes.push({ from, to: from + line.length, insert });
      from += line.length + 1;
    }
    editor.dispatch({ changes, userEvent: "input" });
    return "";
  }
  return "its cell cannot be reached from here";
}

/** The offsets at which whole lines begin in an editor. */
function placesIn({ state }: Editor, lines: readonly string[]): number[] {
  const text = `\n${state.doc.toString()}\n`;
  const wanted = `\n${lines.join("\n")}\n`;
  const places: number[] = [];
  for (let at = text.indexOf(wanted); at >= 0; at = text.indexOf(wanted, at + 1)) places.push(at);
  return places;
}

/** The lines that differ, without their indentation. */
export function changedLines(before: readonly string[], after: readonly string[]): string {
  return after.filter((line, i) => line !== before[i]).join("\n");
}
