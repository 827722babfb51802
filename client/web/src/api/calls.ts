// Calls of the server: JSON in, JSON out. Each shows the marker that foreign pages cannot send.
import type {CompressedSequence, Job, Model, Sequence} from './types';

export class CallError extends Error {
  constructor(readonly code: string, message: string) { super(message); }
  get offline(): boolean { return this.code === 'OFFLINE'; }
}

const kTokenKey = 'pleat.token';
let token = sessionStorage.getItem(kTokenKey) ?? '';
export const currentToken = (): string => token;
export function setToken(text: string): void {
  token = text.trim();
  sessionStorage.setItem(kTokenKey, token);
}

// Hears whether the last request reached the server.
export let onReach: (reached: boolean) => void = () => {};
export function listenToReach(listener: (reached: boolean) => void): void { onReach = listener; }

export async function request(path: string, init: RequestInit = {}): Promise<Response> {
  const headers = new Headers(init.headers);
  headers.set('X-Pleat-Studio', '1');
  if (token) headers.set('Authorization', `Bearer ${token}`);
  let response: Response;
  try {
    response = await fetch(path, {...init, headers, cache: 'no-store', credentials: 'omit'});
  } catch (error) {
    if (error instanceof DOMException && error.name === 'AbortError') throw error;
    onReach(false);
    throw new CallError('OFFLINE', 'The server does not answer. The studio tries again by itself.');
  }
  onReach(true);
  if (response.ok) return response;
  const text = await response.text();
  let code = `HTTP ${response.status}`, message = text || response.statusText;
  try {
    ({code, message} = JSON.parse(text) as {code: string; message: string});
  } catch { /* a proxy has answered */ }
  throw new CallError(code, message);
}

export async function call<T>(method: string, body: object = {}): Promise<T> {
  const response = await request(`/rpc/${method}`, {
    method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify(body),
  });
  return await response.json() as T;
}

// The messages of a stream, one line of JSON each.
export async function* stream<T extends object>(method: string, body: object, signal: AbortSignal): AsyncGenerator<T> {
  const response = await request(`/rpc/${method}`, {
    method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify(body), signal,
  });
  const reader = response.body!.pipeThrough(new TextDecoderStream()).getReader();
  for (let rest = '';;) {
    const {done, value} = await reader.read();
    rest += value ?? '';
    const lines = rest.split('\n');
    rest = lines.pop()!;
    for (const line of lines) {
      if (!line) continue;
      const message = JSON.parse(line) as T & {error?: {code: string; message: string}};
      if (message.error && Object.keys(message).length === 1) {
        throw new CallError(message.error.code, message.error.message);
      }
      yield message as Awaited<T>;
    }
    if (done) return;
  }
}

async function listAll<T>(method: string, key: string): Promise<T[]> {
  const items: T[] = [];
  for (let pageToken = '';;) {
    const page = await call<Record<string, unknown>>(method, {pageToken});
    items.push(...(page[key] as T[] ?? []));
    pageToken = page['nextPageToken'] as string ?? '';
    if (!pageToken) return items;
  }
}
export const listSequences = (): Promise<Sequence[]> => listAll('SequenceService/ListSequences', 'sequences');
export const listCompressed = (): Promise<CompressedSequence[]> => listAll('CompressedSequenceService/ListCompressedSequences', 'compressedSequences');
export const listJobs = (): Promise<Job[]> => listAll('JobService/ListJobs', 'jobs');
export const listModels = (): Promise<Model[]> => listAll('ModelService/ListModels', 'models');

// Offers bytes that the page has, as a file.
export function save(blob: Blob, name: string): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
