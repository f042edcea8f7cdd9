// SPDX-License-Identifier: MIT
// The part of the report that compares two of its pictures with a divider between them.
#include "cli/tradeoff/tradeoff.h"

// The pictures are those of the page that have a name. The script makes everything, so that a reader without
// scripts sees nothing that does not work, and the pictures beside each other further down.
static const char SCRIPT[] =
    "(function () {\n"
    "  'use strict';\n"
    "  var pictures = Array.from(document.querySelectorAll('img[data-name]'));\n"
    "  var box = document.getElementById('slider');\n"
    "  if (pictures.length < 2) { return; }\n"
    "  function add(parent, name, set) {\n"
    "    var node = document.createElement(name);\n"
    "    Object.keys(set).forEach(function (key) { node[key] = set[key]; });\n"
    "    return parent.appendChild(node);\n"
    "  }\n"
    "  function choice(side, first) {\n"
    "    var label = add(box, 'label', {textContent: side + ' '});\n"
    "    var select = add(label, 'select', {});\n"
    "    pictures.forEach(function (picture, i) {\n"
    "      add(select, 'option', {value: i, textContent: picture.dataset.name});\n"
    "    });\n"
    "    select.selectedIndex = first;\n"
    "    select.addEventListener('change', show);\n"
    "    return select;\n"
    "  }\n"
    "  var truth = pictures.findIndex(function (p) { return p.dataset.name === 'the truth'; });\n"
    "  var last = pictures.length - 1;\n"
    "  var left = choice('Left', truth === last ? 0 : last), right = choice('Right', truth);\n"
    "  var stage = add(box, 'div', {className: 'stage'});\n"
    "  var under = add(stage, 'img', {draggable: false});\n"
    "  var over = add(stage, 'img', {className: 'over', draggable: false});\n"
    "  var cut = add(stage, 'div', {className: 'cut'});\n"
    "  var range = add(box, 'input', {type: 'range', min: 0, max: 100, step: 0.5, value: 50});\n"
    "  range.setAttribute('aria-label', 'Divider between the left and the right picture, per cent');\n"
    "  function show() {\n"
    "    under.src = pictures[right.value].src;\n"
    "    under.alt = 'right: ' + pictures[right.value].dataset.name;\n"
    "    over.src = pictures[left.value].src;\n"
    "    over.alt = 'left: ' + pictures[left.value].dataset.name;\n"
    "    over.style.clipPath = 'inset(0 ' + (100 - range.value) + '% 0 0)';\n"
    "    cut.style.left = range.value + '%';\n"
    "  }\n"
    "  function drag(event) {\n"
    "    var area = stage.getBoundingClientRect();\n"
    "    if (event.buttons & 1) {\n"
    "      range.value = 100 * (event.clientX - area.left) / area.width;\n"
    "      show();\n"
    "    }\n"
    "  }\n"
    "  stage.addEventListener('pointerdown', function (event) {\n"
    "    stage.setPointerCapture(event.pointerId);\n"
    "    drag(event);\n"
    "  });\n"
    "  stage.addEventListener('pointermove', drag);\n"
    "  range.addEventListener('input', show);\n"
    "  box.hidden = false;\n"
    "  show();\n"
    "}());\n";

void addSlider(Text* html)
{
    addText(html,
            "<div class=\"slider\" id=\"slider\" hidden><h2>Two pictures compared</h2>\n<p>Drag the divider, "
            "or move it with the arrow keys.</p></div>\n");
}

void addScript(Text* html)
{
    addText(html, "<script>\n%s</script>\n", SCRIPT);
}
