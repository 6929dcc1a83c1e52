//! Accessibility of pages: contrast, names, headings, labels; the rules of WCAG 2.2 AA that a script can check. Our own
//! checks cover lines of charts, sizes of buttons and scrolling; axe-core, if available, covers more rules.

use std::sync::OnceLock;

use crate::chromium::{Chromium, DESK, Look};

/// Returns the script of axe-core if `PINWHEEL_AXE` names one; with `PINWHEEL_REQUIRE_AXE` a missing one is a failure.
fn axe() -> Option<&'static str> {
    static SCRIPT: OnceLock<Option<String>> = OnceLock::new();
    let read = || {
        let Some(file) = std::env::var_os("PINWHEEL_AXE") else {
            assert!(
                std::env::var_os("PINWHEEL_REQUIRE_AXE").is_none(),
                "PINWHEEL_REQUIRE_AXE is set and PINWHEEL_AXE is not: name axe.min.js of the package axe-core in it"
            );
            return None;
        };
        Some(std::fs::read_to_string(&file).unwrap())
    };
    SCRIPT.get_or_init(read).as_deref()
}

/// Returns serious and critical findings of axe-core on the open page, a line each; empty without axe-core.
pub(crate) fn findings(browser: &mut Chromium, look: Look) -> Vec<String> {
    const RUN: &str = "axe.run(document, { resultTypes: ['violations'], RULES }).then((report) => report.violations        .filter((v) => v.impact === 'serious' || v.impact === 'critical')        .map((v) => `${v.id}, ${v.impact}, ${v.nodes.length} times: ${v.nodes[0].html.slice(0, 160)}`))";
    let Some(script) = axe() else {
        return Vec::new();
    };
    if browser.evaluate("typeof axe") == "undefined" {
        browser.evaluate(&format!("{script}; 0"));
    }
    // A theme changes colours alone, and a width all but colours.
    let rules = match look {
        Look { dark: true, .. } => "runOnly: ['color-contrast']",
        Look { width, .. } if width == DESK.width => "rules: {}",
        _ => "rules: { 'color-contrast': { enabled: false } }",
    };
    let lines = browser.evaluate(&RUN.replace("RULES", rules));
    let lines = lines.as_array().unwrap().iter();
    lines
        .map(|line| format!("axe: {}", line.as_str().unwrap()))
        .collect()
}

/// Script that returns faults of the open page, a line each.
pub(crate) const ACCESS: &str = r##"(() => {
  const faults = [];
  const pen = new OffscreenCanvas(1, 1).getContext('2d', { willReadFrequently: true });
  const known = new Map();
  const rgba = (text) => {
    if (!known.has(text)) {
      pen.clearRect(0, 0, 1, 1);
      pen.fillStyle = '#000';
      pen.fillStyle = text;
      pen.fillRect(0, 0, 1, 1);
      const [r, g, b, a] = pen.getImageData(0, 0, 1, 1).data;
      known.set(text, [r, g, b, a / 255]);
    }
    return known.get(text);
  };
  const over = ([r, g, b, a], ground) => [r, g, b].map((v, k) => v * a + ground[k] * (1 - a));
  const luminance = (colour) => {
    const [r, g, b] = colour.map((v) => { const c = v / 255; return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4; });
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const contrast = (a, b) => { const [x, y] = [luminance(a), luminance(b)].sort((p, q) => q - p); return (x + 0.05) / (y + 0.05); };
  const described = (element) => `${element.tagName.toLowerCase()}${element.id ? `#${element.id}` : ''}${element.className?.baseVal === undefined && element.className ? `.${element.className.split(' ').join('.')}` : ''} "${(element.textContent || '').trim().slice(0, 30)}"`;
  const visible = (element) => element.checkVisibility({ checkOpacity: true, checkVisibilityCSS: true }) && !element.closest('.unseen, [hidden], .skip');
  const groundOf = (element) => {
    const layers = [];
    for (let e = element; e; e = e.parentElement) {
      const colour = rgba(getComputedStyle(e).backgroundColor);
      if (colour[3] > 0) layers.push(colour);
      if (colour[3] === 1) break;
    }
    return layers.reduceRight((ground, layer) => over(layer, ground), [255, 255, 255]);
  };
  // ---- Contrast of every text
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const done = new Set();
  for (let node = texts.nextNode(); node; node = texts.nextNode()) {
    const element = node.parentElement;
    if (!node.data.trim() || done.has(element) || element.closest('script, style, noscript, svg, option, [aria-hidden="true"] canvas') || !visible(element)) continue;
    done.add(element);
    const style = getComputedStyle(element);
    let alpha = 1;
    for (let e = element; e; e = e.parentElement) alpha *= Number(getComputedStyle(e).opacity);
    const ground = groundOf(element);
    const [r, g, b, a] = rgba(style.color);
    const ratio = contrast(over([r, g, b, a * alpha], ground), ground);
    const size = parseFloat(style.fontSize);
    const large = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
    if (ratio < (large ? 3 : 4.5)) faults.push(`contrast ${ratio.toFixed(2)}: ${described(element)}`);
  }
  // ---- Lines against the sheet they are drawn on, and apart from each other
  const probe = document.body.appendChild(document.createElement('i'));
  const named = (name) => { probe.style.color = `var(${name})`; return rgba(getComputedStyle(probe).color).slice(0, 3); };
  const sheet = named('--sheet');
  const lines = Array.from({ length: 16 }, (_, k) => named(`--line-${k}`));
  lines.forEach((line, k) => {
    if (contrast(line, sheet) < 3) faults.push(`line ${k}: contrast ${contrast(line, sheet).toFixed(2)}`);
    lines.slice(0, k).forEach((other, n) => { if (Math.hypot(...line.map((v, c) => v - other[c])) < 28) faults.push(`lines ${n} and ${k} look the same`); });
  });
  probe.remove();
  // ---- Names of what can be used
  const nameOf = (e) => {
    const by = (e.getAttribute('aria-labelledby') || '').split(/\s+/).map((id) => document.getElementById(id)?.textContent || '').join('').trim();
    const labels = [...(e.labels || [])].map((l) => l.textContent).join('').trim();
    return e.getAttribute('aria-label') || by || labels || e.getAttribute('alt') || e.textContent.trim() || e.getAttribute('title');
  };
  for (const e of document.querySelectorAll('a[href], button, select, input, summary, [tabindex="0"], [role="img"], [role="region"], nav, img')) {
    if (visible(e) && !nameOf(e)) faults.push(`no name: ${e.outerHTML.slice(0, 100)}`);
    const label = e.getAttribute('aria-label');
    if (label !== null && !label.trim()) faults.push(`empty label: ${e.outerHTML.slice(0, 100)}`);
  }
  for (const e of document.querySelectorAll('select, input')) if (visible(e) && !(e.getAttribute('aria-label') || e.labels?.length || e.getAttribute('aria-labelledby'))) faults.push(`no label: ${e.outerHTML.slice(0, 80)}`);
  // ---- Fingers: 24 px or more
  for (const e of document.querySelectorAll('button, select')) {
    const box = e.getBoundingClientRect();
    if (visible(e) && !e.classList.contains('sort') && (box.height < 24 || box.width < 24)) faults.push(`small to hit, ${box.width.toFixed(0)} x ${box.height.toFixed(0)}: ${described(e)}`);
  }
  // ---- Structure
  const headings = [...document.querySelectorAll('h1, h2, h3, h4')].filter(visible).map((h) => Number(h.tagName[1]));
  if (headings.filter((n) => n === 1).length !== 1) faults.push('not one h1');
  headings.forEach((n, k) => { if (k > 0 && n > headings[k - 1] + 1) faults.push(`heading ${n} follows ${headings[k - 1]}`); });
  const ids = [...document.querySelectorAll('[id]')].map((e) => e.id);
  ids.forEach((id, k) => { if (ids.indexOf(id) !== k) faults.push(`two of #${id}`); });
  for (const e of document.querySelectorAll('[aria-labelledby]')) for (const id of e.getAttribute('aria-labelledby').split(/\s+/)) if (!document.getElementById(id)) faults.push(`aria-labelledby ${id} is not there`);
  for (const e of document.querySelectorAll('a[href^="#"]')) if (!document.getElementById(decodeURIComponent(e.hash.slice(1)))) faults.push(`link to nothing: ${e.hash}`);
  for (const e of document.querySelectorAll('table')) if (visible(e) && !e.querySelector('th[scope]')) faults.push(`table without headings: ${described(e)}`);
  // ---- Scrolling parts can be reached by keys
  for (const e of document.querySelectorAll('main *')) {
    const style = getComputedStyle(e);
    if (visible(e) && ['auto', 'scroll'].includes(style.overflowX) && e.scrollWidth > e.clientWidth + 1 && e.tabIndex < 0 && !e.closest('nav')) faults.push(`scrolls without keys: ${described(e)}`);
  }
  for (const region of ['main', 'header', 'footer', 'nav']) if (!document.querySelector(region)) faults.push(`no ${region}`);
  if (!document.documentElement.lang || !document.title) faults.push('no language or title');
  return [...new Set(faults)].slice(0, 200);
})()"##;
