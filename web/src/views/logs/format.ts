/** Sizes and times of logs for people. */
import { t } from '$lib/i18n';

export function sizeText(bytes: number): string {
  if (bytes < 1000) return t('logs.bytes', { count: bytes });
  if (bytes < 1e6) return t('logs.kilobytes', { count: (bytes / 1000).toFixed(0) });
  return t('logs.megabytes', { count: (bytes / 1e6).toFixed(1) });
}

/** Returns the local date and time of seconds since 1970. */
export function dateText(seconds: number): string {
  if (seconds < 1e6) return t('logs.unknownDate');
  return new Date(seconds * 1000).toLocaleString(undefined, { dateStyle: 'medium', timeStyle: 'short' });
}

/** Returns a duration in ms as `1:02:03` or `2:03`. */
export function durationText(milliseconds: number): string {
  const seconds = Math.max(0, Math.floor(milliseconds / 1000));
  const [hours, minutes, rest] = [Math.floor(seconds / 3600), Math.floor(seconds / 60) % 60, seconds % 60];
  const two = (part: number): string => String(part).padStart(2, '0');
  return hours > 0 ? `${hours}:${two(minutes)}:${two(rest)}` : `${minutes}:${two(rest)}`;
}
