// The page: forms, the worker in which Python runs, and the time that a request may take.
const config = JSON.parse(document.getElementById("config").textContent);
const bar = document.getElementById("starting");
const panels = new Map([...document.querySelectorAll("[data-tab]")].map((e) => [e.dataset.tab, e]));
const tabs = [...document.querySelectorAll('[role="tab"]')];
const address = new URLSearchParams(location.search);

// -- the worker ---------------------------------------------------------------------------------

let worker = null;
let running = null;  // {request, done, timer}: what is being computed
const waiting = new Map();  // tab -> request: only the newest of each tab counts

function begin() {
  bar.hidden = false;
  document.body.dataset.state = "starting";
  worker = new Worker("worker.js", { type: "module" });
  worker.onmessage = ({ data }) => heard(data);
  worker.onerror = (event) => broken(event.message || "the worker did not start");
  worker.postMessage({ kind: "start", config });
}

function heard(data) {
  if (data.kind === "progress") {
    bar.querySelector("progress").value = data.share;
    bar.querySelector("span").textContent = data.words;
  } else if (data.kind === "ready") {
    bar.hidden = true;
    document.body.dataset.state = "ready";
    next();
  } else if (data.kind === "reply") {
    ended(JSON.parse(data.reply));
  } else {
    broken(data.why);
  }
}

function broken(why) {
  // Python itself broke down: what it held may be damaged.
  if (running) restart(config.broken);
  else failed(why);
}

function failed(why) {
  bar.querySelector("progress").hidden = true;
  bar.querySelector("span").textContent = `${config.unstarted} (${why})`;
  bar.classList.add("notice");
  document.body.dataset.state = "failed";
}

function next() {
  if (running || document.body.dataset.state !== "ready" || !waiting.size) return;
  const [tab, request] = waiting.entries().next().value;
  waiting.delete(tab);
  const seconds = config.seconds[tab];
  const timer = setTimeout(() => restart(config.stopped.replace("@", seconds)), 1000 * seconds);
  running = { tab, request, timer, begun: performance.now() };
  panels.get(tab).setAttribute("aria-busy", "true");
  worker.postMessage({ kind: "ask", request: JSON.stringify(request) });
}

function restart(why) {
  worker.terminate();
  begin();
  ended({ problem: why });
}

function ended(reply) {
  const { tab, request, timer, begun } = running;
  clearTimeout(timer);
  running = null;
  panels.get(tab).setAttribute("aria-busy", "false");
  panels.get(tab).dataset.milliseconds = Math.round(performance.now() - begun);
  shown(tab, request, reply);
  next();
}

// -- forms --------------------------------------------------------------------------------------

function valuesOf(tab) {
  const found = {};
  for (const field of panels.get(tab).querySelectorAll("[data-name]")) {
    found[field.dataset.name] = field.type === "checkbox" ? String(field.checked) : field.value;
  }
  return found;
}

function ask(tab, changed = [], action = "") {
  const values = valuesOf(tab);
  const kept = Object.fromEntries(address);
  // What was wanted, and has not begun, is still wanted.
  const before = waiting.get(tab);
  const every = [...(before?.changed ?? []), ...changed];
  waiting.set(tab, { tab, values, kept, changed: every, action: action || before?.action || "" });
  next();
}

const named = (panel, name) =>
  [...panel.querySelectorAll("[data-name]")].find((e) => e.dataset.name === name);

function shown(tab, request, reply) {
  const panel = panels.get(tab);
  const form = panel.querySelector("form");
  const told = panel.querySelector('[data-part="problem"]');
  if (reply.problem) {
    const notice = document.createElement("pre");
    notice.className = "notice";
    notice.setAttribute("role", "alert");
    notice.textContent = reply.problem;
    told.replaceChildren(notice);
    panel.querySelector('[data-part="result"]').replaceChildren();
    // Whoever followed a link that asks too much gets a form to begin with.
    if (!("shape" in form.dataset) && !request.instead) {
      waiting.set(tab, { tab, values: {}, kept: {}, changed: [], action: "", instead: true });
    }
    return;
  }
  if (!request.instead) told.replaceChildren();
  if (form.dataset.shape !== reply.shape) {
    // What was typed while Python worked stays.
    const before = valuesOf(tab);
    const focus = document.activeElement?.dataset?.name;
    const place = document.activeElement?.selectionStart;
    form.innerHTML = reply.controls;
    form.dataset.shape = reply.shape;
    const late = [];
    for (const [name, value] of Object.entries(before)) {
      const field = named(form, name);
      if (!field || value === request.values[name]) continue;
      if (field.type === "checkbox") field.checked = value === "true";
      else field.value = value;
      late.push(name);
    }
    const field = focus && named(form, focus);
    if (field && panel.contains(field)) {
      field.focus();
      if (field.type === "text" && place !== null) field.setSelectionRange(place, place);
    }
    if (late.length) ask(tab, late);
  }
  for (const part of panel.querySelectorAll("[data-part]")) {
    if (part.dataset.part in reply.parts) part.innerHTML = reply.parts[part.dataset.part];
  }
  for (const [key, text] of Object.entries(reply.kept)) {
    if (text && text.length <= config.address) address.set(key, text);
    else address.delete(key);
  }
  write();
}

function write() {
  const text = address.toString();
  history.replaceState(null, "", text ? `?${text}` : location.pathname);
}

// Each field waits for its own next letter: nobody's typing ends the waiting of another.
const pauses = new Map();
for (const [tab, panel] of panels) {
  const form = panel.querySelector("form");
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("input", ({ target }) => {
    const key = JSON.stringify([tab, target.dataset.name]);
    clearTimeout(pauses.get(key));
    const wait = target.matches("select, [type=checkbox]") ? 0 : config.pause;
    pauses.set(key, setTimeout(() => ask(tab, [target.dataset.name]), wait));
  });
  form.addEventListener("click", ({ target }) => {
    if (target.matches("button[data-name]")) {
      target.value = Number(target.value) + 1;
      ask(tab, [target.dataset.name]);
    } else if (target.matches("button[data-action]")) {
      ask(tab, [], target.dataset.action);
    }
  });
}

// -- tabs ---------------------------------------------------------------------------------------

function open(tab) {
  for (const button of tabs) {
    const chosen = button.textContent === tab;
    button.setAttribute("aria-selected", String(chosen));
    button.tabIndex = chosen ? 0 : -1;
    document.getElementById(button.getAttribute("aria-controls")).hidden = !chosen;
  }
  if (tab === tabs[0].textContent) address.delete("tab");
  else address.set("tab", tab);
  write();
  if (panels.has(tab) && !("shape" in panels.get(tab).querySelector("form").dataset)) ask(tab);
}

for (const [k, button] of tabs.entries()) {
  button.addEventListener("click", () => open(button.textContent));
  button.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const other = tabs[(k + step + tabs.length) % tabs.length];
    other.focus();
    open(other.textContent);
  });
}

// -- the start ----------------------------------------------------------------------------------

async function keep() {
  // A page that is opened from a disk, or over a plain network, has nobody who keeps files.
  if (!("serviceWorker" in navigator)) return;
  try {
    const { installing } = await navigator.serviceWorker.register("service.js");
    // Where it cannot keep files (no room), it is given up, and never ready.
    const gone = new Promise((done) => {
      installing?.addEventListener("statechange", () => {
        if (installing.state === "redundant") done();
      });
    });
    await Promise.race([navigator.serviceWorker.ready, gone]);
    if (!navigator.serviceWorker.controller) {
      await new Promise((done) => {
        navigator.serviceWorker.addEventListener("controllerchange", done, { once: true });
        setTimeout(done, 2000);
      });
    }
  } catch {
    // Without it the page works, and is loaded anew each time.
  }
}

const first = tabs.find((button) => button.textContent === address.get("tab")) ?? tabs[0];
open(first.textContent);
if (location.protocol === "file:") failed(config.from_disk);
else keep().then(begin);
