function connect(player, stage, graphs) {
  const get = (id) => document.getElementById(id);
  const { recording } = player;
  get("scrub").max = recording.duration;
  for (const speed of SPEEDS) get("speed").add(new Option(`${speed}×`, speed));
  recording.bodies.forEach((body, k) => get("body").add(new Option(body.id, k)));

  const show = () => {
    stage.draw();
    for (const graph of graphs) graph.follow();
    get("scrub").value = player.time;
    get("clock").value = `${player.time.toFixed(2)} / ${recording.duration.toFixed(2)} s`;
    get("play").textContent = player.playing && !player.wind ? "❚❚" : "▶";
    get("rewind").setAttribute("aria-pressed", player.playing && player.wind < 0);
    get("forward").setAttribute("aria-pressed", player.playing && player.wind > 0);
    get("speed").value = player.speed;
    get("body").value = player.body;
    for (const name of ["loop", "vectors", "trails"]) get(name).checked = player[name];
  };
  const layout = () => {
    stage.resize();
    for (const graph of graphs) graph.draw();
    show();
  };
  const choose = (body) => {
    if (body < 0) return;
    player.body = body;
    for (const graph of graphs) graph.draw();
    show();
  };
  const flip = (name) => {
    player[name] = !player[name];
    show();
  };
  player.changed = show;

  const actions = {
    start: () => player.seek(0), rewind: () => player.windTo(-1), back: () => player.step(-1),
    play: () => player.toggle(), step: () => player.step(1), forward: () => player.windTo(1),
  };
  for (const [id, act] of Object.entries(actions)) get(id).addEventListener("click", act);
  for (const name of ["loop", "vectors", "trails"]) get(name).addEventListener("change", () => flip(name));
  get("scrub").addEventListener("input", (e) => {
    const time = Number(e.target.value); // before pausing, which shows the old time
    player.pause();
    player.seek(time);
  });
  get("speed").addEventListener("change", (e) => {
    player.speed = Number(e.target.value);
    show();
  });
  get("body").addEventListener("change", (e) => choose(Number(e.target.value)));
  stage.canvas.addEventListener("pointerup", (e) => {
    const body = stage.bodyAt(e.clientX, e.clientY);
    if (body < 0) player.toggle();
    else choose(body);
  });

  const keys = {
    " ": actions.play, ArrowRight: actions.step, ArrowLeft: actions.back, Home: actions.start,
    End: () => player.seek(recording.duration), j: actions.rewind, k: actions.forward,
    "+": () => player.changeSpeed(1), "=": () => player.changeSpeed(1), "-": () => player.changeSpeed(-1),
    l: () => flip("loop"), v: () => flip("vectors"), t: () => flip("trails"),
  };
  document.addEventListener("keydown", (e) => {
    const act = keys[e.key] || keys[e.key.toLowerCase()];
    const on = (selector) => e.target instanceof Element && e.target.matches(selector);
    const typing = on("select") || (on("button, input[type=checkbox]") && e.key === " ");
    if (!act || typing || e.ctrlKey || e.metaKey || e.altKey) return;
    e.preventDefault();
    act();
  });
  window.addEventListener("resize", layout);
  layout();
}

function run() {
  const recording = new Recording(JSON.parse(document.getElementById("data").textContent));
  const player = new Player(recording);
  const stage = new Stage(document.getElementById("stage"), player);
  const parent = document.getElementById("graphs");
  const graphs = recording.bodies.length
    ? ["position", "velocity", "energy", "momentum"].map((quantity) => new Graph(parent, player, quantity))
    : [];
  connect(player, stage, graphs);
  let last;
  const tick = (now) => {
    if (last !== undefined) player.advance(Math.min((now - last) / 1000, 0.25)); // a hidden tab does not jump
    last = now;
    requestAnimationFrame(tick);
  };
  requestAnimationFrame(tick);
  window.player = player;
}

run();
