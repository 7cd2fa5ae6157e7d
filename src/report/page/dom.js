// Elements of the page. Texts are set as texts, never parsed: they come from files.
'use strict';

// make('td', {class: 'best', 'aria-label': text, onclick: f}, 'text', element, ...)
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) {
      element.addEventListener(name.slice(2), value);
    } else {
      element.setAttribute(name, value === true ? '' : value);
    }
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return element;
}

function makeButton(text, action, attributes = {}) {
  return make('button', {type: 'button', onclick: action, ...attributes}, text);
}

let choiceCount = 0;

// A labelled list of {value, text}, or of {group, choices}; `changed` gets the value.
function makeChoice(label, choices, value, changed) {
  const id = `choice-${++choiceCount}`;
  const option = (choice) => choice.choices ?
      make('optgroup', {label: choice.group}, choice.choices.map(option)) :
      make('option', {value: choice.value}, choice.text);
  const select = make('select', {id, onchange: () => changed(select.value)}, choices.map(option));
  select.value = value;
  return make('span', {class: 'choice'}, make('label', {for: id
              }, label), select);
}

// One of several states, as a group of buttons; returns the group and how to set it from outside.
function makeSwitch(label, choices, value, changed) {
  const buttons = choices.map((choice) => makeButton(choice.text, () => {
                                set(choice.value);
                                changed(choice.value);
                              }, {title: choice.title}));
  const set = (wanted) => choices.forEach(
      (choice, k) => buttons[k].setAttribute('aria-pressed', String(choice.value === wanted)));
  set(value);
  return {
    element: make('div', {class: 'switch', role: 'group', 'aria-label': label}, buttons),
    set
  };
}

// Redraws when the width of an element changes, and once at the start.
function onWidth(element, draw) {
  let width = 0;
  const look = () => {
    const now = Math.floor(element.clientWidth);
    if (now > 0 && now !== width) draw(width = now);
  };
  new ResizeObserver(() => requestAnimationFrame(look)).observe(element);
  look();
}
