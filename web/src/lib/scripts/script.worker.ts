/**
 * The worker of a user script: it runs the program that its first message brings.
 *
 * The station serves this file with a content security policy of its own (`SCRIPT_POLICY` of `server/app.py`), which
 * is the one that binds the worker: it allows `eval` and nothing else.
 */
import type { ScriptProgram } from './sandbox';

addEventListener('message', ({ data }: MessageEvent<ScriptProgram>) => void (0, eval)(data.program), { once: true });
