// The link of the page with `abbe view`, over HTTP.

/// Opens the example that the address names, such as `view#prism`.
const openAddress = () => location.hash.length > 1 ? post({ open: decodeURIComponent(location.hash.slice(1)) }) : null;
addEventListener("hashchange", () => location.reload());

/// Asks for an answer: `plane` is the number, width and height of its picture, if it has values of
/// pixels.
async function get(path) {
  await opened;
  const answer = await fetch(path);
  if (!answer.ok) throw new Error(path + ": " + answer.status);
  const plane = ["picture", "width", "height"].map(name => Number(answer.headers.get("x-abbe-" + name)));
  return { kind: answer.headers.get("content-type"), plane, bytes: await answer.arrayBuffer() };
}

/// Sends orders: changes of the scene, a pause, more passes.
const post = orders => fetch("orders", { method: "POST", body: JSON.stringify(orders) });
const opened = openAddress();
