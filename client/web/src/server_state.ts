// The lists of the server, the jobs that are watched, and a server that goes away and comes back.
import {call, CallError, listenToReach, listCompressed, listJobs, listModels, listSequences, request, setToken, stream} from './api/calls';
import {isFinal, type About, type Job} from './api/types';
import {ask, byId} from './panels/dom';
import type {Studio} from './studio';
import {noteObjective} from './panels/training';

const kRetrySeconds = [1, 2, 4, 8, 15];

export class ServerState {
  private readonly watched = new Set<string>();
  private failures = 0;
  private timer = 0;
  private asking = false;
  online = true;

  constructor(private readonly studio: Studio, private readonly finished: (job: Job) => void, private readonly show: () => void) {
    listenToReach((reached) => this.reach(reached));
  }

  async refresh(): Promise<void> {
    try {
      const [about, takes, jobs, models, compressed] = await Promise.all([
        request('/studio/about').then((response) => response.json() as Promise<About>), listSequences(), listJobs(), listModels(), listCompressed()]);
      Object.assign(this.studio, {about, takes, jobs, models, compressed});
    } catch (error) {
      if (!(error instanceof CallError) || error.code !== 'UNAUTHENTICATED') throw error;
      if (await this.askToken(error.message)) return this.refresh();
      throw error;
    }
    for (const job of this.studio.jobs) if (!isFinal(job.state)) void this.watch(job.id);
    this.show();
  }
  private async askToken(why: string): Promise<boolean> {
    if (this.asking) return false;
    this.asking = true;
    const token = await ask('This server asks who you are', `${why}. Token:`, '');
    this.asking = false;
    if (token) setToken(token);
    return Boolean(token);
  }

  // Follows a job to its end, across restarts of the server.
  async watch(id: string): Promise<void> {
    if (this.watched.has(id)) return;
    this.watched.add(id);
    try {
      for (;;) {
        try {
          for await (const {job} of stream<{job: Job}>('JobService/WatchJob', {id}, new AbortController().signal)) {
            this.studio.jobs = [...this.studio.jobs.filter((other) => other.id !== id), job];
            noteObjective(job);
            this.show();
            if (!isFinal(job.state)) continue;
            await this.refresh();
            return this.finished(job);
          }
        } catch (error) {
          if (error instanceof CallError && ['NOT_FOUND', 'PERMISSION_DENIED', 'UNAUTHENTICATED'].includes(error.code)) return;
        }
        await new Promise((done) => setTimeout(done, 1500));  // the server restarts: it goes on with the job
      }
    } finally {
      this.watched.delete(id);
    }
  }

  private reach(reached: boolean): void {
    const changed = reached !== this.online;
    this.online = reached;
    const line = byId('server');
    line.classList.toggle('lost', !reached);
    if (reached) {
      line.textContent = 'server: ok';
      this.failures = 0;
      clearTimeout(this.timer);
      this.timer = 0;
      if (!changed) return;
      this.studio.live.retryNow();
      void this.refresh().catch(() => {});
      return;
    }
    if (this.timer) return;
    const seconds = kRetrySeconds[Math.min(this.failures++, kRetrySeconds.length - 1)]!;
    this.countDown(seconds);
  }
  private countDown(seconds: number): void {
    byId('server').textContent = `server: no answer, next try in ${seconds} s`;
    this.timer = window.setTimeout(() => {
      if (seconds > 1) return this.countDown(seconds - 1);
      this.timer = 0;
      request('/studio/about').catch(() => {});
    }, 1000);
  }
  // Asks now and then, so that a server that has gone is noticed although nothing is done.
  keepLooking(): void {
    setInterval(() => { if (this.online && !document.hidden) request('/studio/about').catch(() => {}); }, 5000);
  }
  cancel(job: Job): Promise<unknown> { return call('JobService/CancelJob', {id: job.id}); }
}
