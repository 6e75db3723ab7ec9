// Makes the pages of docs/ that the page links to: node docs.mjs FOLDER
// Each row of a table and each section has an id, the same in both languages; messages.json has the messages that
// the rows quote, so that the page finds the row of an event.
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { marked } from 'marked';

const kPage = 'troubleshooting';
const kLanguages = [
  { lang: 'en', file: `${kPage}.md`, made: `${kPage}.html`, back: 'rc10 Studio' },
  { lang: 'zh', file: `${kPage}.zh-CN.md`, made: `${kPage}.zh.html`, back: 'rc10 Studio' },
];
const docs = fileURLToPath(new URL('../docs/', import.meta.url));
const folder = process.argv[2];

/** As GitHub makes them. */
function slug(heading) {
  return heading.toLowerCase().replace(/[^\p{L}\p{N} _-]/gu, '').replaceAll(' ', '-');
}

const sections = readFileSync(join(docs, kLanguages[0].file), 'utf8')
  .split('\n')
  .filter((line) => line.startsWith('## '))
  .map((line) => slug(line.slice(3)));

function htmlOf(markdown) {
  let row = 0;
  let section = 0;
  return marked
    .parse(markdown)
    .replace(/<tbody>.*?<\/tbody>/gs, (body) => body.replaceAll('<tr>', () => `<tr id="row-${++row}">`))
    .replaceAll('<h2>', () => `<h2 id="${sections[section++]}">`)
    // The other pages are not here.
    .replace(/<a href="([^"#]*)(#[^"]*)?">(.*?)<\/a>/gs, (_, page, _place, text) =>
      page.startsWith(kPage) ? `<a href="${page.includes('zh') ? kLanguages[1].made : kLanguages[0].made}">${text}</a>` : text)
    .replaceAll('<pre>', '<pre tabindex="0">')
    .replaceAll('<table>', '<div class="scroll" tabindex="0" role="group"><table>')
    .replaceAll('</table>', '</table></div>');
}

function pageOf({ lang, file, back }) {
  const markdown = readFileSync(join(docs, file), 'utf8');
  const title = markdown.match(/^# (.*)$/m)[1];
  return `<!doctype html>
<html lang="${lang}">
  <head>
    <meta charset="utf-8">
    <meta name="viewport" content="width=device-width, initial-scale=1">
    <meta name="color-scheme" content="light dark">
    <title>${title}</title>
    <link rel="icon" href="/icon.svg" type="image/svg+xml">
    <link rel="stylesheet" href="/studio.css">
  </head>
  <body class="docs">
    <nav><a href="/">${back}</a></nav>
    <main>${htmlOf(markdown)}</main>
  </body>
</html>
`;
}

/** The messages of each row: the code in its first cell. */
function messagesOf(markdown) {
  const rows = marked.lexer(markdown).flatMap((token) => (token.type === 'table' ? token.rows : []));
  return rows.map((cells) =>
    cells[0].tokens.filter((token) => token.type === 'codespan').map((token) => token.text.trim()),
  );
}

mkdirSync(folder, { recursive: true });
for (const language of kLanguages) writeFileSync(join(folder, language.made), pageOf(language));
const english = readFileSync(join(docs, kLanguages[0].file), 'utf8');
writeFileSync(join(folder, 'messages.json'), JSON.stringify(messagesOf(english)));
