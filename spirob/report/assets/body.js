"use strict";
// An arm of hinged units: where its parts are for given hinge angles, in mm, base at the origin.
function Body({ length, halfWidth, faceSlope, guideBefore, guideAfter }) {
  const units = length.length;
  const place = ([x, y, c, s], px, py) => [x + c * px - s * py, y + s * px + c * py];

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
  function outline(pose, i) {
    const k = Math.min(i, units - 2), taper = (halfWidth[k + 1] / halfWidth[k]) ** 0.25;
    const wide = halfWidth[i] / taper, slim = halfWidth[i] * taper, end = length[i], slope = faceSlope[i];
    return [[0, 0], [wide * slope, wide], [end - slim * slope, slim], [end, 0],
      [end - slim * slope, -slim], [wide * slope, -wide]].map(([a, b]) => place(pose, a, b));
  }
  // Both flanks as one closed line: what is seen of an arm from afar.
  function silhouette(found) {
    const left = [], right = [];
    for (let i = 0; i < units; i++) {
      left.push(place(found[i], length[i] / 2, halfWidth[i]));
      right.push(place(found[i], length[i] / 2, -halfWidth[i]));
    }
    return [[0, halfWidth[0]], ...left, found[units], ...right.reverse(), [0, -halfWidth[0]]];
  }
  function tendon(found, side) {
    const points = [[0, side * guideBefore[0][1]]];
    for (let i = 0; i < units; i++) {
      if (i) points.push(place(found[i - 1], length[i - 1] + guideBefore[i][0], side * guideBefore[i][1]));
      points.push(place(found[i], guideAfter[i][0], side * guideAfter[i][1]));
    }
    return points;
  }
  const straight = poses(new Float64Array(units), 0);
  return { units, halfWidth, poses, outline, silhouette, tendon, straight };
}
