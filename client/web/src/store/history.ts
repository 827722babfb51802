// Undo and redo over values that never change.
export class History<T> {
  private past: {value: T; label: string}[] = [];
  private future: {value: T; label: string}[] = [];
  private joined: string | null = null;
  constructor(private current: T, private readonly changed: () => void, private readonly limit = 500) {}

  get value(): T { return this.current; }
  get undoLabel(): string | undefined { return this.past.at(-1)?.label; }
  get redoLabel(): string | undefined { return this.future.at(-1)?.label; }

  // gesture: changes with the same name that follow each other, such as those of one drag, are one step.
  change(value: T, label: string, gesture: string | null = null): void {
    if (gesture === null || gesture !== this.joined) {
      this.past.push({value: this.current, label});
      if (this.past.length > this.limit) this.past.shift();
    }
    this.joined = gesture;
    this.future = [];
    this.current = value;
    this.changed();
  }
  undo(): boolean { return this.move(this.past, this.future); }
  redo(): boolean { return this.move(this.future, this.past); }
  // Forgets all steps.
  reset(value: T): void {
    this.past = [];
    this.future = [];
    this.joined = null;
    this.current = value;
    this.changed();
  }

  private move(from: {value: T; label: string}[], to: {value: T; label: string}[]): boolean {
    const step = from.pop();
    if (!step) return false;
    to.push({value: this.current, label: step.label});
    this.joined = null;
    this.current = step.value;
    this.changed();
    return true;
  }
}
