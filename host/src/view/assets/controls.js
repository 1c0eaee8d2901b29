// What is turned: sliders, lists, and the panel of a pack.

const $ = (id) => document.getElementById(id);

const colours = () => {
  const style = getComputedStyle(document.documentElement);
  return new Proxy({}, { get: (_, name) => style.getPropertyValue(`--${name}`).trim() });
};

function element(tag, properties, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

// A labelled slider that shows its value.
function slider({ id, label, min, max, step, value, change }) {
  // The value is read aloud with the slider, not a second time.
  const output = element("output", { ariaLive: "off" });
  output.htmlFor = id;
  const input = element("input", { id, type: "range", min, max, step, value });
  const say = () => input.setAttribute("aria-valuetext", (output.textContent = Number(input.value).toFixed(2)));
  input.addEventListener("input", () => {
    say();
    change(Number(input.value));
  });
  say();
  const name = element("span", { id: `${id}-name`, textContent: label });
  input.setAttribute("aria-labelledby", name.id);
  return element("label", { className: "slider", htmlFor: id }, name, output, input);
}

// The controls of a pack.
function panel(pack, index) {
  const state = kinesic.controls[index];
  const { label, help } = CONTROLS[pack.engine] ?? STRENGTH;
  const [low, high] = pack.plausible;
  const warning = element("span", { className: "warn small" });
  const changed = () => {
    const outside = state.strength < low || state.strength > high;
    warning.textContent = outside ? `outside the plausible range of this pack, ${low.toFixed(2)} to ${high.toFixed(2)}` : "";
    kinesic.results[index]?.change();
    kinesic.stale = true;
  };
  const set = element("fieldset", {}, element("legend", { textContent: pack.name }));
  const shown = element("input", { type: "checkbox", id: `shown-${index}`, checked: true });
  shown.addEventListener("change", () => { state.shown = shown.checked; show(); });
  set.append(element("p", { className: "soft small", textContent: `${pack.engine}, ${moving(pack).length} joints, ${pack.rate} frames a second, ${pack.size} bytes` }));
  if (pack.machine) set.append(element("p", { className: "soft small", textContent: "Within the limits of the servos that the pack holds, as on the device." }));
  set.append(element("label", {}, shown, " shown"));
  set.append(slider({ id: `strength-${index}`, label: `${label} (${help})`, min: -0.5, max: 2.5, step: 0.05, value: state.strength,
    change: (value) => { state.strength = value; changed(); } }), warning);
  if (pack.engine === "mechanics" && kinesic.data.clips.length > 1) set.append(mixing(index, changed));
  set.append(mask(pack, index, changed));
  return set;
}

// Expression from another clip.
function mixing(index, changed) {
  const options = kinesic.data.clips.map((clip, k) => element("option", { value: k, textContent: clip.name }));
  const select = element("select", { id: `other-${index}` }, element("option", { value: "", textContent: "this clip" }), ...options);
  select.addEventListener("change", () => {
    kinesic.controls[index].other = select.value === "" ? null : Number(select.value);
    mixed(index);
    changed();
  });
  return element("label", { className: "row" }, "Expression of ", select);
}

function mixed(index) {
  const { other } = kinesic.controls[index];
  const result = kinesic.results[index];
  if (result) result.other = other === null ? null : recorded(index, other).source;
}

// Weights of the joints.
function mask(pack, index, changed) {
  const weights = kinesic.controls[index].mask;
  const sliders = moving(pack).map(([name, joint]) =>
    [joint, slider({ id: `mask-${index}-${joint}`, label: name, min: 0, max: 1, step: 0.05, value: 1, change: (value) => { weights[joint] = value; changed(); } })]);
  const all = (choose) => () => {
    sliders.forEach(([joint, made]) => {
      const input = made.querySelector("input");
      const value = choose(joint);
      if (value === null || Number(input.value) === value) return;
      input.value = value;
      input.dispatchEvent(new Event("input"));
    });
  };
  const button = (id, text, choose) => {
    const made = element("button", { id: `${id}-${index}`, type: "button", textContent: text });
    made.addEventListener("click", all(choose));
    return made;
  };
  const legs = new Set(pack.legs);
  const buttons = element("div", { className: "buttons" }, button("all", "all", () => 1), button("none", "none", () => 0));
  if (legs.size) buttons.append(button("upper", "upper body", (joint) => (legs.has(joint) ? 0 : 1)), button("legs", "legs", (joint) => (legs.has(joint) ? 1 : 0)));
  return element("details", {}, element("summary", { textContent: "Joints" }), buttons,
    element("div", { className: "mask" }, ...sliders.map(([, made]) => made)));
}
