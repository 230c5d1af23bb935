"use strict";
// Everything that moves on the page starts here.
document.querySelectorAll(".plot").forEach((place) => {
  if (place.id !== "overlay") plots.show(place.id, readJson(`${place.id}-figure`));
});
startOverlay();
startArm();
