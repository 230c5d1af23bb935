"use strict";
// The moment that the page looks at: a trial and a time in it.  Whoever shows it listens.
const moment = {
  trial: null,
  seconds: 0,
  listeners: [],
  set(trial, seconds, source) {
    moment.trial = trial;
    moment.seconds = seconds;
    moment.listeners.forEach((listener) => listener(source));
  },
};
