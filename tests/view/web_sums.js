// Renders scenes by the WebAssembly module, and prints the hashes of their sums.
// node web_sums.js FOLDER PASSES CHANGES SCENE…
const fs = require("fs"), vm = require("vm");
const [folder, passes, changes, ...scenes] = process.argv.slice(2);
vm.runInThisContext(fs.readFileSync(folder + "/abbe_web.js", "utf8") + "; globalThis.wasm_bindgen = wasm_bindgen;");
wasm_bindgen.initSync({ module: fs.readFileSync(folder + "/abbe_web_bg.wasm") });
for (const scene of scenes) {
  const engine = new wasm_bindgen.Engine();
  engine.load(fs.readFileSync(scene, "utf8"), JSON.parse(changes), []);
  const start = process.cpuUsage().user, pieces = engine.render(0, 1, Number(passes), 0, () => true);
  const seconds = (process.cpuUsage().user - start) / 1e6;
  engine.add(pieces);
  console.log(engine.hashOfSums(), seconds);
}
