/**
 * The worker of a user script: it runs the program that its first message brings.
 *
 * The station serves this file with a content security policy of its own (`SCRIPT_POLICY` of `server/app.py`), which
 * is the one that binds the worker: it allows `eval` and nothing else.
 */
import type { ScriptProgram } from './sandbox';

// The program is the user's: a worker without network and storage is its place (`sandbox.ts`).
// biome-ignore lint/security/noGlobalEval: running it is the purpose of the worker
// biome-ignore lint/complexity/noCommaOperator: an indirect call, so that the program sees no names of this module
addEventListener('message', ({ data }: MessageEvent<ScriptProgram>) => void (0, eval)(data.program), { once: true });
