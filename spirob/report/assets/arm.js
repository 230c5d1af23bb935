"use strict";
// The arm from its hinge angles: each unit turns about its hinge and carries the next.
function startArm() {
  const stored = readJson("arm-data");
  const canvas = document.getElementById("arm");
  if (!stored || !canvas || !stored.trials.length) return;
  const [play, slider, clock, choice] = ["play", "time", "clock", "trial"].map(
    (name) => document.getElementById(`arm-${name}`));
  const { length, halfWidth, faceSlope, guideBefore, guideAfter } = stored.geometry;
  const units = length.length;
  const straight = new Float64Array(units);
  const context = canvas.getContext("2d");
  let trial, box, tip, playing = null;

  // Pose of each unit: [x, y, cos, sin] of its hinge, and last the tip.
  function poses(angles, first) {
    const found = [];
    let x = 0, y = 0, heading = 0;
    for (let i = 0; i < units; i++) {
      heading += angles[first + i];
      const c = Math.cos(heading), s = Math.sin(heading);
      found.push([x, y, c, s]);
      x += length[i] * c;
      y += length[i] * s;
    }
    found.push([x, y, 1, 0]);
    return found;
  }
  const place = ([x, y, c, s], px, py) => [x + c * px - s * py, y + s * px + c * py];

  function outline(pose, i) {
    const w = halfWidth[i], taper = i + 1 < units ? (halfWidth[i + 1] / w) ** 0.25 : 0.977;
    const wide = w / taper, slim = w * taper, end = length[i];
    return [[0, 0], [wide * faceSlope, wide], [end - slim * faceSlope, slim], [end, 0],
      [end - slim * faceSlope, -slim], [wide * faceSlope, -wide]].map(([a, b]) => place(pose, a, b));
  }
  function tendon(found, side) {
    const points = [[0, side * guideBefore[0][1]]];
    for (let i = 0; i < units; i++) {
      if (i) points.push(place(found[i - 1], length[i - 1] + guideBefore[i][0], side * guideBefore[i][1]));
      points.push(place(found[i], guideAfter[i][0], side * guideAfter[i][1]));
    }
    return points;
  }

  function load(k) {
    trial = { time: unpack(stored.trials[k].time), angles: unpack(stored.trials[k].angles) };
    tip = [];
    box = { left: 0, right: 0, low: 0, high: 0 };
    let most = -1, poster = 0;
    const cover = (pose) => pose.forEach(([x, y], i) => {
      const margin = halfWidth[Math.min(i, units - 1)];
      box.left = Math.min(box.left, x - margin); box.right = Math.max(box.right, x + margin);
      box.low = Math.min(box.low, y - margin); box.high = Math.max(box.high, y + margin);
    });
    cover(poses(straight, 0));
    for (let frame = 0; frame < trial.time.length; frame++) {
      const found = poses(trial.angles, frame * units);
      cover(found);
      tip.push(found[units]);
      if (Math.abs(found[units][1]) > most) { most = Math.abs(found[units][1]); poster = frame; }
    }
    slider.max = trial.time.length - 1;
    slider.value = poster;
    draw();
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
    const frame = Number(slider.value), colour = theme.colour;
    poses(straight, 0).slice(0, units).forEach((pose, i) => line(outline(pose, i), colour("--line"), 1, null));
    line(tip.slice(0, frame + 1), colour("--neutral"), 1);
    const found = poses(trial.angles, frame * units);
    found.slice(0, units).forEach((pose, i) => line(outline(pose, i), colour("--named"), 1, colour("--arm")));
    [1, -1].forEach((side) => line(tendon(found, side), colour("--ink"), 1.2));
    line([[0, -1.25 * halfWidth[0]], [0, 1.25 * halfWidth[0]]], colour("--ink"), 3);
    ruler(scale, high, colour);
    const seconds = trial.time[frame] - trial.time[0];
    clock.textContent = `${seconds.toFixed(1)} s`;
    slider.setAttribute("aria-valuetext", `${seconds.toFixed(1)} seconds`);
  }
  function ruler(scale, high, colour) {
    context.strokeStyle = context.fillStyle = colour("--muted");
    context.lineWidth = 1.5;
    context.beginPath(); context.moveTo(1, high - 6); context.lineTo(1 + 100 * scale, high - 6); context.stroke();
    context.font = "12px system-ui, sans-serif";
    context.fillText("100 mm", 1 + 100 * scale + 8, high - 2);
  }

  function stop() { cancelAnimationFrame(playing); playing = null; play.textContent = "Play"; }
  function start() {
    const last = trial.time.length - 1;
    if (Number(slider.value) >= last) slider.value = 0;
    const offset = trial.time[slider.value];
    let began = null;
    const step = (now) => {
      began ??= now;
      const until = offset + (now - began) / 1000;
      let frame = Number(slider.value);
      while (frame < last && trial.time[frame + 1] <= until) frame++;
      slider.value = frame;
      draw();
      if (frame >= last) stop(); else playing = requestAnimationFrame(step);
    };
    play.textContent = "Pause";
    playing = requestAnimationFrame(step);
  }
  stored.trials.forEach((entry, k) => choice.add(new Option(entry.name, k)));
  play.addEventListener("click", () => (playing === null ? start() : stop()));
  slider.addEventListener("input", () => { stop(); draw(); });
  choice.addEventListener("change", () => { stop(); load(choice.value); });
  new ResizeObserver(draw).observe(canvas);
  theme.listeners.push(draw);
  load(0);
}
