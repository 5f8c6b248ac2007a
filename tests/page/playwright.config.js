// Runs the page in a real Chromium, from disk. CHROMIUM names the browser; by default it is the one that Debian installs.
import { defineConfig } from '@playwright/test';

export default defineConfig({
  testMatch: '*.spec.js',
  timeout: 60_000,
  // a failure is a failure: nothing is tried again
  retries: 0,
  workers: 1,
  reporter: 'list',
  use: {
    headless: true,
    viewport: { width: 1280, height: 900 },
    launchOptions: { executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox', '--disable-gpu'] },
  },
});
