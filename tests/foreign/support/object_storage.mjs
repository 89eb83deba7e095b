// Servers of object storage that are not ours, for tests: nginx, and s3rver behind a check of signatures.

import assert from 'node:assert/strict';
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { createHash, createHmac } from 'node:crypto';
import { mkdirSync, writeFileSync } from 'node:fs';
import { once } from 'node:events';
import { createServer as createHttpServer, request as httpRequest } from 'node:http';
import { createServer } from 'node:net';
import { join } from 'node:path';

import S3rver from 's3rver';

const program = process.env.SCANCAST_PROGRAM;
const patienceMs = 30_000;

export const hasNginx = spawnSync('nginx', ['-v']).status === 0;

/** Asynchronously: servers of this very process answer meanwhile. */
export async function run(words, environment = {}, command = program) {
  const child = spawn(command, words, { env: { ...process.env, ...environment }, stdio: ['ignore', 'pipe', 'pipe'], timeout: patienceMs });
  let said = '';
  for (const output of [child.stdout, child.stderr]) output.on('data', (data) => { said += data; });
  const [code] = await once(child, 'close');
  return { code, said };
}

export async function comesTrue(condition, what) {
  const end = Date.now() + patienceMs;
  while (!await condition()) {
    assert.ok(Date.now() < end, `${what} within ${patienceMs} ms`);
    await new Promise((done) => setTimeout(done, 25));
  }
}

async function freePort() {
  const server = createServer();
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  const { port } = server.address();
  await new Promise((done) => server.close(done));
  return port;
}

/** nginx over the files in FOLDER/web, by http and, under TLS, by HTTP/2; `known` is there already. */
export async function startNginx(folder, known) {
  const [plain, secure] = [await freePort(), await freePort()];
  for (const name of ['certificate', 'logs']) mkdirSync(join(folder, name));
  execFileSync('openssl', ['req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1', '-nodes', '-days', '2', '-subj', '/CN=localhost',
    '-addext', 'subjectAltName=DNS:localhost', '-keyout', join(folder, 'certificate/key.pem'), '-out', join(folder, 'certificate/cert.pem')], { stdio: 'ignore' });
  const temporary = ['client_body', 'proxy', 'fastcgi', 'uwsgi', 'scgi'].map((name) => `${name}_temp_path ${folder}/${name};`).join(' ');
  writeFileSync(join(folder, 'nginx.conf'), `
    daemon off; worker_processes 1; pid ${folder}/pid; error_log ${folder}/logs/error.log;
    events { worker_connections 256; }
    http {
      access_log ${folder}/logs/access.log; ${temporary}
      server {
        listen 127.0.0.1:${plain};
        listen 127.0.0.1:${secure} ssl http2;
        ssl_certificate ${folder}/certificate/cert.pem; ssl_certificate_key ${folder}/certificate/key.pem;
        root ${folder}/web;
        location /signed/ { limit_except GET { deny all; } if ($request_method = HEAD) { return 403; } alias ${folder}/web/; }
        location /down/ { return 302 http://127.0.0.1:${plain}/town.scan; }
        location /moved/ { return 302 /town.scan; }
        location /loop/ { return 302 /loop/town.scan; }
        location /whole/ { max_ranges 0; alias ${folder}/web/; }
      }
    }`);
  const child = spawn('nginx', ['-p', folder, '-c', join(folder, 'nginx.conf')], { stdio: 'ignore' });
  await comesTrue(() => fetch(`http://127.0.0.1:${plain}${known}`).then((got) => got.ok, () => false), 'nginx answers');
  return { child, plain: `http://127.0.0.1:${plain}`, secure: `https://localhost:${secure}`, port: plain };
}

/**
 * What signs a request, by Amazon's own description ("Create a signed AWS API request"): s3rver looks whether there is such an account,
 * and does not reckon this.
 */
function signatureOf(request, { scope, signed }, secret) {
  const hash = (text) => createHash('sha256').update(text).digest('hex');
  const mac = (key, text) => createHmac('sha256', key).update(text).digest();
  const { pathname, search } = new URL(request.url, 'http://x');
  const headers = signed.split(';').map((name) => `${name}:${request.headers[name].trim()}\n`).join('');
  const canonical = [request.method, pathname, search.slice(1), headers, signed, request.headers['x-amz-content-sha256']].join('\n');
  const toSign = ['AWS4-HMAC-SHA256', request.headers['x-amz-date'], scope, hash(canonical)].join('\n');
  const key = scope.split('/').reduce(mac, `AWS4${secret}`);
  return mac(key, toSign).toString('hex');
}

/** Lets signed requests through to `port`, and no others. */
async function startSignatureCheck(port) {
  const server = createHttpServer((request, response) => {
    const [, scope, signed, signature] =
      /^AWS4-HMAC-SHA256 Credential=[^/]+\/([^,]+), *SignedHeaders=([^,]+), *Signature=([0-9a-f]+)$/.exec(request.headers.authorization ?? '') ?? [];
    if (!signature || !signed.split(';').includes('host') || signatureOf(request, { scope, signed }, 'S3RVER') !== signature) {
      response.writeHead(403).end('<Error><Code>SignatureDoesNotMatch</Code></Error>');
      return;
    }
    const onward = httpRequest({ port, host: '127.0.0.1', method: request.method, path: request.url, headers: request.headers }, (answer) => {
      response.writeHead(answer.statusCode, answer.headers);
      answer.pipe(response);
    });
    request.pipe(onward);
  });
  await new Promise((done) => server.listen(0, '127.0.0.1', done));
  server.unref();
  return server;
}

/** A bucket `scans` in FOLDER/s3, behind a check of signatures. */
export async function startS3(folder) {
  const directory = join(folder, 's3');
  mkdirSync(directory);
  const server = new S3rver({ port: 0, address: '127.0.0.1', silent: true, directory, configureBuckets: [{ name: 'scans', configs: [] }] });
  const check = await startSignatureCheck((await server.run()).port);
  const { port } = check.address();
  const environment = {
    AWS_ACCESS_KEY_ID: 'S3RVER', AWS_SECRET_ACCESS_KEY: 'S3RVER', AWS_SESSION_TOKEN: '', AWS_REGION: 'us-east-1', AWS_ENDPOINT_URL: `http://127.0.0.1:${port}`,
  };
  // curl signs by itself what ours asks curl's library to sign.
  const curl = async (key, ...words) => {
    const address = `http://127.0.0.1:${port}/scans/${key.split('/').map(encodeURIComponent).join('/')}`;
    const { code, said } = await run(['-sS', '--fail', '--aws-sigv4', 'aws:amz:us-east-1:s3', '--user', 'S3RVER:S3RVER',
      '-H', 'x-amz-content-sha256: UNSIGNED-PAYLOAD', ...words, address], {}, 'curl');
    assert.equal(code, 0, said);
  };
  return {
    environment,
    put: (file, key) => curl(key, '-T', file),
    remove: (key) => curl(key, '-X', 'DELETE'),
    async stop() {
      check.closeAllConnections?.();
      check.close();
      server.httpServer.closeAllConnections?.();
      await server.close();
    },
  };
}
