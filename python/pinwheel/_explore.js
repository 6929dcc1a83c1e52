// The live page in a cell: its questions go to the kernel as messages, for the browser may be on another machine.

// Inside of the page: `fetch` asks the cell, and a link to another page of the program opens what the kernel answers.
const INSIDE = `<script>(() => {
  const waiting = new Map();
  let asked = 0;
  window.fetch = (path, { method = 'GET', body, signal } = {}) => new Promise((done, fail) => {
    const id = (asked += 1);
    waiting.set(id, done);
    signal?.addEventListener('abort', () => fail(signal.reason));
    parent.postMessage({ id, path, method, body }, '*');
  });
  addEventListener('message', ({ source, data: { id, status, text } }) => {
    if (source !== parent || !waiting.has(id)) return;
    waiting.get(id)(new Response(text, { status }));
    waiting.delete(id);
  });
  addEventListener('click', async (event) => {
    const link = event.target.closest?.('a:not([href^="#"], [href*=":"])');
    if (!link) return;
    event.preventDefault();
    const page = await (await fetch(link.getAttribute('href'))).text();
    open(URL.createObjectURL(new Blob([page], { type: 'text/html' })));
  }, true);
  history.replaceState = () => {}; // a page that is no address of its own keeps none
})();</script>`;

export default {
  render({ model, el }) {
    const frame = document.createElement('iframe');
    frame.style = `width: 100%; height: ${model.get('height')}px; border: 0`;
    frame.sandbox = 'allow-scripts allow-popups allow-downloads';
    frame.title = 'Pinwheel explore';
    const view = Math.random(); // a cell may be shown twice
    const ask = ({ source, data }) => {
      if (source === frame.contentWindow) model.send({ ...data, view });
    };
    const hear = (answer) => {
      if (answer.view !== view) return;
      if (answer.id === undefined) frame.srcdoc = answer.text.replace('<head>', () => `<head>${INSIDE}`);
      else frame.contentWindow?.postMessage(answer, '*');
    };
    window.addEventListener('message', ask);
    model.on('msg:custom', hear);
    el.append(frame);
    model.send({ path: '', view });
    return () => {
      window.removeEventListener('message', ask);
      model.off('msg:custom', hear);
    };
  },
};
