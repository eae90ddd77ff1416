import { FOREVER, type Script, showWidget } from "../export/host.ts";
import { momentOf, type Named, parseMoment, showMoment, toHash } from "../export/moment.ts";
import { type PageFacts, toModels, toNamed } from "../export/page.ts";
import { readPart } from "../export/parts.ts";
import { explainWords } from "../later/glossary.ts";
import { offerLinks } from "../shared/link.ts";

/**
 * Puts widgets into a page of the documentation, with the state that they had when the page was built;
 * scripts/docs_site.py writes it. They react to the pointer as in a notebook, without a kernel.
 */

/** Scripts and stylesheets of the widgets, as the package ships them. */
const WIDGETS = new URL("./widgets/", import.meta.url);

/** A widget is requested when it is a screen away from view. */
const AHEAD = "100%";

/** The theme's styles do not reach the widgets, nor theirs the page. */
const BOXES = `
:host { display: block; }
.rw-page-item { box-sizing: border-box; }`;

const texts = new Map<string, Promise<string>>();
const places = [...document.querySelectorAll<HTMLElement>("[data-rw-live]")];
/** The models of each widget on the page that is shown. */
const shown = new Map<HTMLElement, Named>();

/** The address of a moment: with several widgets on the page, it names the one around the element. */
function toLink(element: Element): string {
  const root = element.getRootNode();
  const host = root instanceof ShadowRoot ? (root.host as HTMLElement) : null;
  const named = host && shown.get(host);
  if (!host || !named) return "";
  return `${location.href.split("#")[0]}${toHash({ ...momentOf(named), widget: places.indexOf(host) })}`;
}

/** Scrolls to the widget whose moment the address names. */
function goToLinked(): void {
  const moment = parseMoment(location.hash);
  const place = moment && places[moment.widget ?? 0];
  if (!moment || !place) return;
  place.scrollIntoView({ block: "center" });
  const named = shown.get(place);
  if (named) showMoment(named, moment);
}

function textOf(url: URL): Promise<string> {
  const known = texts.get(url.href) ?? fetch(url).then((answer) => (answer.ok ? answer.text() : refuse(url, answer)));
  texts.set(url.href, known);
  return known;
}

function refuse(url: URL, answer: Response): never {
  throw new Error(`${url.pathname}: ${answer.status} ${answer.statusText}`);
}

async function show(place: HTMLElement): Promise<void> {
  const text = await textOf(new URL(place.dataset.rwLive ?? "", document.baseURI));
  const { facts, bytes } = await readPart<Pick<PageFacts, "models" | "buffers" | "root">>(text);
  const names = [...new Set(facts.models.map(({ widget }) => widget))];
  const made = new Map<string, Script | (() => Script)>();
  for (const name of names) made.set(name, (await import(new URL(`${name}.js`, WIDGETS).href)).default);
  const css = (await Promise.all(names.map((name) => textOf(new URL(`${name}.css`, WIDGETS))))).join("\n");
  const models = toModels(facts, bytes, css);
  const named = toNamed(facts, models);
  shown.set(place, named);
  const moment = parseMoment(location.hash);
  if (moment && places[moment.widget ?? 0] === place) showMoment(named, moment);
  const scripts = new Map<string, Script>();
  for (const { id, widget } of facts.models) {
    const script = made.get(widget) as Script | (() => Script);
    scripts.set(id, typeof script === "function" ? script() : script);
  }
  const root = place.attachShadow({ mode: "open" });
  const style = document.createElement("style");
  style.textContent = BOXES + css;
  root.append(style);
  await showWidget(facts.root, models, scripts, root, FOREVER);
}

/** Passes the reader's choice of the theme's colours on to the widgets. */
function followScheme(): void {
  const tell = () => {
    document.body.dataset.theme = document.body.dataset.mdColorScheme === "slate" ? "dark" : "light";
  };
  new MutationObserver(tell).observe(document.body, { attributes: true, attributeFilter: ["data-md-color-scheme"] });
  tell();
}

followScheme();
explainWords(document);
const seen = new IntersectionObserver(
  (entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      seen.unobserve(target);
      show(target as HTMLElement).catch((error) => {
        (target.shadowRoot ?? target).textContent = `This widget cannot be shown: ${error.message}`;
      });
    }
  },
  { rootMargin: AHEAD },
);
offerLinks(toLink);
for (const place of places) seen.observe(place);
goToLinked();
window.addEventListener("hashchange", goToLinked);
