// Checks the spelling of the book, the README and the other texts: every word is in the British dictionary or in words.txt.
//
//   node spelling.mjs            exit code 1 and a list of `file:line: word`
//
//   Code (in fences and in backticks), formulas, links, comments and HTML tags are not checked.
import nspell from 'nspell';
import dictionary from 'dictionary-en-gb';
import { readFileSync, readdirSync } from 'node:fs';
import { dirname, join, relative } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const root = join(here, '..');
const spell = nspell(dictionary);
readFileSync(join(here, 'words.txt'), 'utf8').split('\n').filter((w) => w && !w.startsWith('#')).forEach((w) => spell.add(w));

// keeps the line breaks, so that the line numbers stay right
const blank = (text) => text.replace(/[^\n]/g, ' ');
function prose(markdown) {
  return markdown
    .replace(/^ *(`{3,}|~{3,})[\s\S]*?^ *\1 *$/gm, blank)
    .replace(/<!--[\s\S]*?-->/g, blank)
    .replace(/\{\{[\s\S]*?\}\}/g, blank)
    .replace(/\$\$[\s\S]+?\$\$/g, blank)
    .replace(/`[^`\n]+`/g, blank)
    .replace(/(?<![\\$])\$(?!\s)[^$\n]+?(?<!\s)\$(?!\d)/g, blank)
    .replace(/\]\([^)]*\)/g, blank)
    .replace(/https?:\S+/g, blank)
    .replace(/ alt="([^"]*)"/g, (_, words) => `      ${words} `)
    .replace(/<[^>]+>/g, blank);
}

const texts = ['README.md', 'DESIGN.md', 'CONTRIBUTING.md', 'scenes/README.md', 'book/README.md'].map((f) => join(root, f));
const chapters = readdirSync(join(here, 'src')).filter((f) => f.endsWith('.md')).map((f) => join(here, 'src', f));
let unknown = 0;
for (const file of [...texts, ...chapters]) {
  prose(readFileSync(file, 'utf8')).split('\n').forEach((line, i) => {
    for (const [word] of line.matchAll(/\p{L}[\p{L}’']*\p{L}/gu)) {
      const plain = word.replaceAll('’', "'").replace(/'s$/, '');
      // symbols such as TᵏE, and words in capitals, are no words of a language
      if (/[^\x00-\x7fÀ-ÿ]/.test(plain) || plain === plain.toUpperCase() || spell.correct(plain)) continue;
      console.log(`${relative(root, file)}:${i + 1}: ${word}`);
      unknown += 1;
    }
  });
}
if (unknown) {
  console.error(`error: ${unknown} unknown words\nhelp: mend them, or add a word of the field to book/words.txt`);
  process.exit(1);
}
