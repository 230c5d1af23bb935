"use strict";
// The arm of the model, on top of the robot's where that is known, with a slider over time.
function startArm() {
  const stored = readJson("arm-data");
  const canvas = document.getElementById("arm");
  if (!stored || !canvas || !stored.trials.length) return;
  const [play, slider, clock, choice, distance] = ["play", "time", "clock", "trial", "apart"].map(
    (name) => document.getElementById(`arm-${name}`));
  const context = canvas.getContext("2d");
  const model = Body(stored.geometry);
  const robot = stored.robot && Body(stored.robot.geometry);
  let shown, seen, box, tip, playing = null;

  const frames = (entry) => ({ name: entry.name, time: unpack(entry.time), angles: unpack(entry.angles) });
  function at(times, seconds) { // frame that is on at that time
    let low = 0, high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= seconds + 1e-6) low = middle; else high = middle - 1;
    }
    return low;
  }

  function load(k) {
    shown = frames(stored.trials[k]);
    const twin = robot && stored.robot.trials.find((entry) => entry.name === shown.name);
    seen = twin ? frames(twin) : null;
    tip = [];
    box = { left: 0, right: 0, low: 0, high: 0 };
    let most = -1, poster = 0;
    const cover = (body, pose) => pose.forEach(([x, y], i) => {
      const margin = body.halfWidth[Math.min(i, body.units - 1)];
      box.left = Math.min(box.left, x - margin); box.right = Math.max(box.right, x + margin);
      box.low = Math.min(box.low, y - margin); box.high = Math.max(box.high, y + margin);
    });
    cover(model, model.straight);
    for (let frame = 0; frame < shown.time.length; frame++) {
      const found = model.poses(shown.angles, frame * model.units);
      cover(model, found);
      tip.push(found[model.units]);
      if (Math.abs(found[model.units][1]) > most) { most = Math.abs(found[model.units][1]); poster = frame; }
    }
    for (let frame = 0; seen && frame < seen.time.length; frame++) {
      cover(robot, robot.poses(seen.angles, frame * robot.units));
    }
    slider.max = shown.time.length - 1;
    slider.value = poster;
    show();
  }

  function draw() {
    const ratio = devicePixelRatio || 1, wide = canvas.clientWidth, high = canvas.clientHeight;
    canvas.width = wide * ratio;
    canvas.height = high * ratio;
    const scale = Math.min(wide / (box.right - box.left), (high - 22) / (box.high - box.low));
    const shiftX = wide / 2 - scale * (box.left + box.right) / 2;
    const shiftY = (high - 22) / 2 + scale * (box.low + box.high) / 2;
    const screen = ([x, y]) => [shiftX + scale * x, shiftY - scale * y];
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const line = (points, colour, width, fill) => {
      context.beginPath();
      points.forEach((point, k) => context[k ? "lineTo" : "moveTo"](...screen(point)));
      if (fill !== undefined) context.closePath();
      if (fill) { context.fillStyle = fill; context.fill(); }
      if (colour) { context.strokeStyle = colour; context.lineWidth = width; context.stroke(); }
    };
    const frame = Number(slider.value), colour = theme.colour, seconds = shown.time[frame];
    line(model.silhouette(model.straight), colour("--line"), 1, null);
    line(tip.slice(0, frame + 1), colour("--neutral"), 1);
    const found = model.poses(shown.angles, frame * model.units);
    const real = seen && robot.poses(seen.angles, at(seen.time, seconds) * robot.units);
    if (real) {
      real.slice(0, robot.units).forEach((pose, i) => line(robot.outline(pose, i), null, 0, colour("--robot")));
      line(robot.silhouette(real), colour("--measured"), 1.2, null);
    }
    const inside = real ? null : colour("--arm");
    found.slice(0, model.units).forEach((pose, i) => line(model.outline(pose, i), colour("--named"), 1.2, inside));
    if (!real) [1, -1].forEach((side) => line(model.tendon(found, side), colour("--ink"), 1.2));
    line([[0, -1.25 * model.halfWidth[0]], [0, 1.25 * model.halfWidth[0]]], colour("--ink"), 3);
    ruler(scale, high, colour);
    const since = seconds - shown.time[0];
    clock.textContent = `${since.toFixed(1)} s`;
    slider.setAttribute("aria-valuetext", `${since.toFixed(1)} seconds`);
    if (distance && real) {
      const [a, b] = [found[model.units], real[robot.units]];
      distance.textContent = `tips ${Math.hypot(a[0] - b[0], a[1] - b[1]).toFixed(0)} mm apart`;
    }
  }
  function ruler(scale, high, colour) {
    context.strokeStyle = context.fillStyle = colour("--muted");
    context.lineWidth = 1.5;
    context.beginPath(); context.moveTo(1, high - 6); context.lineTo(1 + 100 * scale, high - 6); context.stroke();
    context.font = "12px system-ui, sans-serif";
    context.fillText("100 mm", 1 + 100 * scale + 8, high - 2);
  }
  function show() {
    draw();
    moment.set(shown.name, shown.time[slider.value], "arm");
  }

  function stop() { cancelAnimationFrame(playing); playing = null; play.textContent = "Play"; }
  function start() {
    const last = shown.time.length - 1;
    if (Number(slider.value) >= last) slider.value = 0;
    const offset = shown.time[slider.value];
    let began = null;
    const step = (now) => {
      began ??= now;
      slider.value = Math.max(Number(slider.value), at(shown.time, offset + (now - began) / 1000));
      show();
      if (Number(slider.value) >= last) stop(); else playing = requestAnimationFrame(step);
    };
    play.textContent = "Pause";
    playing = requestAnimationFrame(step);
  }
  function follow(source) { // somebody else looks at another moment
    if (source === "arm") return;
    const k = stored.trials.findIndex((entry) => entry.name === moment.trial);
    if (k < 0) return;
    stop();
    if (stored.trials[k].name !== shown.name) { choice.value = k; load(k); }
    if (moment.seconds === null) return;
    slider.value = at(shown.time, moment.seconds);
    show();
  }
  stored.trials.forEach((entry, k) => choice.add(new Option(entry.name, k)));
  play.addEventListener("click", () => (playing === null ? start() : stop()));
  slider.addEventListener("input", () => { stop(); show(); });
  choice.addEventListener("change", () => { stop(); load(choice.value); });
  new ResizeObserver(draw).observe(canvas);
  theme.listeners.push(draw);
  load(0);
  moment.listeners.push(follow);
}
