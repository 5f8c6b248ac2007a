// mdBook preprocessor: formulas to static HTML.
//
//   $…$ in a line and $$…$$ on its own become KaTeX markup with MathML beside it for screen readers. Code, in fences or in
//   backticks, is left alone. An error in a formula stops the build and names the chapter.
import katex from 'katex';
import { readFileSync } from 'node:fs';

// mdBook asks first whether we can serve a renderer
if (process.argv[2] === 'supports') process.exit(process.argv[3] === 'html' ? 0 : 1);

const macros = {
  '\\T': '\\mathcal{T}', // one bounce
  '\\K': '\\mathcal{K}', // scatter
  '\\G': '\\mathcal{G}', // propagate
  '\\E': '\\mathbb{E}', //  expectation
  '\\Var': '\\operatorname{Var}',
  '\\norm': '\\lVert #1 \\rVert',
};
const options = { output: 'htmlAndMathml', throwOnError: true, strict: 'error' };

const CODE = /(^ *(`{3,}|~{3,})[\s\S]*?^ *\2 *$|`[^`\n]+`)/m;
const DISPLAY = /\$\$([\s\S]+?)\$\$/g;
const INLINE = /(?<![\\$])\$(?!\s)([^$\n]+?)(?<!\s)\$(?!\d)/g; // "$5 and $6" is money

// Markdown reads the text between HTML tags: its marks must not look like emphasis, code, links or escapes. The outline of a
// root has line ends, which would end a row of a table.
const plain = (html) => html.replace(/\n/g, ' ').replace(/>([^<]+)</g, (_, text) => `>${text.replace(/[*_`\\[\]~|]/g, (c) => `&#${c.charCodeAt(0)};`)}<`);

function page(name, markdown) {
  const tex = (source, displayMode) => {
    try {
      return plain(katex.renderToString(source, { ...options, displayMode, macros: { ...macros } }));
    } catch (error) {
      throw new Error(`${name}: ${error.message}\n  in: ${source}`);
    }
  };
  const prose = (text) => text.replace(DISPLAY, (_, s) => tex(s, true)).replace(INLINE, (_, s) => tex(s, false));
  let out = '';
  for (let rest = markdown; rest; ) {
    const code = CODE.exec(rest);
    if (!code) return out + prose(rest);
    out += prose(rest.slice(0, code.index)) + code[0];
    rest = rest.slice(code.index + code[0].length);
  }
  return out;
}

function walk(items) {
  for (const { Chapter: chapter } of items ?? []) {
    if (!chapter) continue; // a separator or the title of a part
    chapter.content = page(chapter.name, chapter.content);
    walk(chapter.sub_items);
  }
}

const [, book] = JSON.parse(readFileSync(0, 'utf8'));
walk(book.items ?? book.sections); // mdBook 0.5, 0.4
process.stdout.write(JSON.stringify(book));
