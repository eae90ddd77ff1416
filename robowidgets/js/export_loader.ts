import { explain, findParts, readPart } from "./export/parts.ts";

/** Puts the packed scripts and stylesheets into the page. Its policy allows only these, by hash. */
async function load(): Promise<void> {
  const [element] = findParts("program");
  if (!element) throw new Error("this page is not whole");
  const { facts, bytes } = await readPart<{ texts: ["style" | "script", number][] }>(element.textContent);
  let at = 0;
  for (const [tag, length] of facts.texts) {
    const added = document.createElement(tag);
    if (tag === "script") (added as HTMLScriptElement).type = "module";
    added.textContent = new TextDecoder().decode(bytes.subarray(at, at + length));
    document.head.append(added);
    at += length;
  }
}

if (typeof DecompressionStream === "undefined") {
  explain(
    "This browser cannot unpack this page: it has no DecompressionStream. Chromium 80, Firefox 113, Safari 16.4 and later do.",
  );
} else {
  load().catch((error) => explain(`This page cannot be shown: ${error}`));
}
