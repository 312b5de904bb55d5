// Drags the pressed object to and fro for `seconds`, and returns when the pictures came in ms, and
// how many columns they had.
async seconds => {
  const at = x => {
    const place = placement(), box = stage.getBoundingClientRect();
    return { clientX: box.left + place.left + (x + 0.5) * place.scale, clientY: box.top + place.top + 130.5 * place.scale };
  };
  const [pointerId] = pointers.keys(), begin = performance.now(), times = [], columns = [], plainDraw = draw;
  const before = picture.number;
  draw = async () => {
    await plainDraw();
    if (picture.number === before || !picture.coarse) return;
    times.push(performance.now() - begin);
    columns.push(picture.coarse.size[0]);
  };
  for (let t = 0; t < 1000 * seconds; t = performance.now() - begin) {
    const x = 95 + 20 * Math.sin((t + 50) / 500);
    stage.dispatchEvent(new PointerEvent("pointermove", { pointerId, buttons: 1, ...at(x) }));
    await new Promise(done => setTimeout(done, 16));
  }
  draw = plainDraw;
  return { times, columns };
}
