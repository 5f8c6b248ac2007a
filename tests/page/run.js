// The runs whose pages are tested: made once by the program, in a temporary folder.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const root = fileURLToPath(new URL('../..', import.meta.url));
const program = process.env.FREDHOLM ?? join(root, 'target/release/fredholm');

/** @typedef {{folder: string, page: string, summary: any}} Made */

/** @type {Map<string, Made>} */
const made = new Map();

/** @param {string} name @param {string[]} args @returns {Made} */
function make(name, args) {
  const found = made.get(name);
  if (found) return found;
  const folder = join(process.env.PAGES ?? mkdtempSync(join(tmpdir(), 'fredholm-page-')), name);
  if (!existsSync(join(folder, 'index.html'))) {
    execFileSync(program, [...args, '-o', folder, '--quiet'], { stdio: ['ignore', 'ignore', 'inherit'], cwd: root });
  }
  const summary = JSON.parse(readFileSync(join(folder, 'summary.json'), 'utf8'));
  const run = { folder, page: pathToFileURL(join(folder, 'index.html')).href, summary };
  made.set(name, run);
  return run;
}

/** The Cornell box, three ways: terms, path tracer, matrix. */
export const box = () =>
  make('box', ['series', 'cornell', '--worlds', 'terms,path,radiosity', '--size', '96x96', '--spp', '256', '--patches', '300']);

/** The furnace with terms only, without roulette: nothing is known of what lies beyond K. */
export const terms = () =>
  make('terms', ['series', 'furnace', '--worlds', 'terms', '--size', '24x16', '--spp', '64', '--max-bounces', '3', '--roulette', 'none']);
