// What the page has besides the live view: example scenes, a link that contains the scene, and
// files to take along.

const examples = JSON.parse(embedded("abbe-examples"));
/// The number of pixels of a picture, and that of its spectral bands. Both decide the memory of each
/// worker.
const PIXELS = 320 * 180, BANDS = 20;

/// Returns the text of a scene for a picture of this page's size, with the shape of its own film.
function sized(scene) {
  const film = scene.film ?? { width: 16, height: 9 };
  const width = Math.max(1, Math.round(Math.sqrt(PIXELS * film.width / film.height)));
  const height = Math.max(1, Math.round(width * film.height / film.width));
  return JSON.stringify({ ...scene, film: { ...film, width, height, spectral_bands: BANDS } }, null, 2);
}

async function throughStream(bytes, stream) {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}

/// Returns text as the end of an address: deflated, in the letters of base64url.
async function packed(text) {
  const bytes = await throughStream(new TextEncoder().encode(text), new CompressionStream("deflate-raw"));
  return btoa(Array.from(bytes, byte => String.fromCharCode(byte)).join("")).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "");
}
async function unpacked(letters) {
  const bytes = Uint8Array.from(atob(letters.replace(/-/g, "+").replace(/_/g, "/")), letter => letter.charCodeAt(0));
  return new TextDecoder().decode(await throughStream(bytes, new DecompressionStream("deflate-raw")));
}

/// Opens the scene that the address names: `#prism` for an example, `#scene=…` for a shared one.
async function openAddress() {
  const name = decodeURIComponent(location.hash.slice(1)), shared = name.startsWith("scene=");
  const known = examples[name] ? name : "prism";
  changes.clear();
  moves.clear();
  choose(null);
  forbidden = [];
  try {
    openScene(shared ? await unpacked(name.slice(6)) : sized(examples[known]));
    $("example").value = shared ? "" : known;
  } catch (error) {
    say("The link does not contain a scene");
    openScene(sized(examples.prism));
  }
}

function say(text) {
  $("said").textContent = text;
  $("said").hidden = false;
}
const bar = element("div", "", { id: "site", className: "row" });
bar.innerHTML = `<label class="grow">Example <select id="example"><option value="" hidden>shared scene</option></select></label>
<button id="share">Copy link</button><button id="command" title="Copy the command that renders this scene">Command line</button><output id="said" aria-live="polite" hidden></output>`;
document.querySelector("header").append(bar);
for (const [name, scene] of Object.entries(examples)) $("example").add(new Option(scene.title ?? name.replace(/_/g, " "), name));
$("example").onchange = () => { location.hash = $("example").value; };
$("share").onclick = async () => {
  const address = location.href.split("#")[0] + "#scene=" + await packed(await leader.ask("text"));
  history.replaceState(null, "", address);
  await navigator.clipboard?.writeText(address).catch(() => {});
  say("The address contains the scene");
};
$("command").onclick = async () => {
  const command = "abbe render scene.json";
  await navigator.clipboard?.writeText(command).catch(() => {});
  say(`Save the scene, and run: ${command}`);
};
addEventListener("hashchange", () => { if (!location.hash.startsWith("#scene=")) openAddress(); });
openAddress();
