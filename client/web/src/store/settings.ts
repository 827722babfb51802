// What the page remembers on this machine.
import type {FramesChoice} from '../worker/messages';

export interface Settings {
  modelId: string; takeId: string; views: string; coloring: string; scaleMm: number; showBones: boolean;
  showNames: boolean; libraryOpen: boolean; sideOpen: boolean; loop: boolean; showCurves: boolean;
  frames: FramesChoice;  // how live frames come
}
const kKey = 'pleat.settings';
const kDefaults: Settings = {
  modelId: '', takeId: '', views: 'edited', coloring: 'none', scaleMm: 25, showBones: true, showNames: false,
  libraryOpen: true, sideOpen: true, loop: true, showCurves: false, frames: 'auto',
};

export function loadSettings(): Settings {
  try {
    return {...kDefaults, ...JSON.parse(localStorage.getItem(kKey) ?? '{}') as Partial<Settings>};
  } catch {
    return {...kDefaults};
  }
}
export function saveSettings(settings: Settings): void {
  try {
    localStorage.setItem(kKey, JSON.stringify(settings));
  } catch { /* private windows may not store */ }
}

const editsKey = (modelId: string): string => `pleat.edits.${modelId}`;
export function saveEdits(modelId: string, text: string | null): void {
  try {
    if (text === null) localStorage.removeItem(editsKey(modelId));
    else localStorage.setItem(editsKey(modelId), text);
  } catch { /* as above */ }
}
export const loadEdits = (modelId: string): string | null => localStorage.getItem(editsKey(modelId));
