// Small helpers for elements.
type Child = Node | string | null | undefined | false;
export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K, attributes: Record<string, string | boolean | number | ((event: Event) => void)> = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === 'function') node.addEventListener(name, value as EventListener);
    else if (typeof value === 'boolean') node.toggleAttribute(name, value);
    else node.setAttribute(name, String(value));
  }
  node.append(...children.filter((child): child is Node | string => child !== null && child !== undefined && child !== false));
  return node;
}
export function byId<T extends HTMLElement = HTMLElement>(id: string): T {
  const node = document.getElementById(id);
  if (!node) throw new Error(`the page has no #${id}`);
  return node as T;
}

export const shortId = (id: string): string => id.slice(0, 8);
export function bytesText(bytes: number): string {
  const units = ['B', 'kB', 'MB', 'GB'];
  let unit = 0;
  for (; bytes >= 1000 && unit < 3; ++unit) bytes /= 1000;
  return `${bytes < 10 && unit ? bytes.toFixed(1) : Math.round(bytes)} ${units[unit]}`;
}
export function durationText(seconds: number): string {
  if (seconds < 60) return `${Math.max(1, Math.round(seconds))} s`;
  return `${Math.floor(seconds / 60)} min ${Math.round(seconds % 60)} s`;
}

// One line at the bottom that says what has happened; errors stay until they are closed.
export function say(text: string, kind: 'info' | 'error' = 'info'): void {
  const host = byId('messages');
  const line = element('div', {class: `message ${kind}`, role: kind === 'error' ? 'alert' : 'status'}, text,
    element('button', {type: 'button', 'aria-label': 'Close this message', click: () => line.remove()}, '×'));
  host.append(line);
  if (kind === 'info') setTimeout(() => line.remove(), 6000);
  while (host.children.length > 4) host.firstElementChild!.remove();
}
export const sayError = (error: unknown): void => say(error instanceof Error ? error.message : String(error), 'error');

export async function ask(title: string, label: string, value: string): Promise<string | null> {
  const input = element('input', {value, 'aria-label': label});
  return (await dialog(title, [element('label', {}, label, input)], 'OK')) ? input.value.trim() : null;
}
export const confirmed = (title: string, text: string, action: string): Promise<boolean> => dialog(title, [element('p', {}, text)], action);

// True: the action was chosen. Escape and the other button say no.
export function dialog(title: string, content: Node[], action: string | null): Promise<boolean> {
  return new Promise((done) => {
    const box = element('dialog', {'aria-label': title},
      element('form', {method: 'dialog'}, element('h2', {}, title), ...content,
        element('div', {class: 'buttons'}, element('button', {value: 'no', type: 'submit', class: 'quiet', formnovalidate: true}, action ? 'Cancel' : 'Close'),
          action ? element('button', {value: 'yes', type: 'submit', class: 'main'}, action) : null)));
    // Enter means the action, which is not the first button.
    box.addEventListener('keydown', (event) => {
      event.stopPropagation();
      if (event.key !== 'Enter' || !(event.target instanceof HTMLInputElement) || !action) return;
      event.preventDefault();
      box.close('yes');
    });
    box.addEventListener('close', () => {
      done(box.returnValue === 'yes');
      box.remove();
    });
    document.body.append(box);
    box.showModal();
  });
}
