/** Rates, sizes, ages and shares as the tables of the view write them. */
import { t } from '$lib/i18n';

export function rateText(rate: number): string {
  return t('inspect.perSecond', { rate: rate.toFixed(rate < 9.95 ? 1 : 0) });
}

export function flowText(bytes: number): string {
  if (bytes < 1000) return t('inspect.bytesPerSecond', { count: Math.round(bytes) });
  return t('inspect.kilobytesPerSecond', { count: (bytes / 1000).toFixed(1) });
}

export function ageText(milliseconds: number): string {
  const seconds = Math.max(0, milliseconds) / 1000;
  if (seconds < 120) return t('inspect.seconds', { count: seconds.toFixed(seconds < 10 ? 1 : 0) });
  return t('inspect.minutes', { count: Math.round(seconds / 60) });
}

export function shareText(share: number): string {
  const percent = share * 100;
  return `${percent === 0 ? '0' : percent < 0.095 ? '<0.1' : percent.toFixed(1)} %`;
}
