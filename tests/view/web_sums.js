// Renders scenes by the WebAssembly module, and prints the hashes of their sums.
// node web_sums.js FOLDER PASSES CHANGES SCENE…
const fs = require("fs"), vm = require("vm");
const [folder, passes, changes, ...scenes] = process.argv.slice(2);
vm.runInThisContext(fs.readFileSync(folder + "/abbe_web.js", "utf8") + "; globalThis.wasm_bindgen = wasm_bindgen;");
wasm_bindgen.initSync({ module: fs.readFileSync(folder + "/abbe_web_bg.wasm") });
for (const scene of scenes) {
  const engine = new wasm_bindgen.Engine();
  engine.load(fs.readFileSync(scene, "utf8"), JSON.parse(changes), []);
  const start = process.cpuUsage().user, bytes = engine.render(0, 1, Number(passes), undefined, () => true);
  console.log(engine.hashOfSums([bytes]), (process.cpuUsage().user - start) / 1e6);
}
