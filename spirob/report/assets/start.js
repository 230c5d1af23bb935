"use strict";
// Everything that moves on the page starts here.
document.querySelectorAll(".plot").forEach((place) => {
  if (place.id !== "overlay") plots.show(place.id, readJson(`${place.id}-figure`));
});
startSwitches();
startOverlay();
startArm();
startBar();
// A link to something folded unfolds it.
function unfold() {
  const target = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
  const folded = target && target.closest("details");
  if (folded) { folded.open = true; target.scrollIntoView(); }
}
addEventListener("hashchange", unfold);
unfold();
