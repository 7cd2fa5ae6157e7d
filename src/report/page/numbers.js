// Numbers as people read them: three digits, whatever their size.
'use strict';

const kNothing = '\u2013';

function isNumber(value) { return typeof value === 'number' && Number.isFinite(value); }

// 0.0123, 1.23e-5, 12,300: `digits` significant digits.
function formatNumber(value, digits = 3) {
  if (!isNumber(value)) return kNothing;
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size < 1e-3 || size >= 1e7) {
    return value.toExponential(digits - 1).replace('e+', 'e').replace(/-/g, '\u2212');
  }
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return value
      .toLocaleString('en', {minimumFractionDigits: decimals, maximumFractionDigits: decimals})
      .replace(/-/g, '\u2212');
}

function formatCount(value) { return isNumber(value) ? value.toLocaleString('en') : kNothing; }

function formatSeconds(value) {
  return isNumber(value) ? formatNumber(value) + '\u202fs' : kNothing;
}

// How many times `value` is less than `base`, in words.
function formatGain(value, base) {
  if (!isNumber(value) || !isNumber(base) || value <= 0 || base <= 0) return '';
  return value <= base ? `${formatNumber(base / value)}\u00d7 less than unfiltered` :
                         `${formatNumber(value / base)}\u00d7 more than unfiltered`;
}

// Exponents, -0.67
function formatSlope(value) {
  return isNumber(value) ? value.toFixed(2).replace('-', '\u2212') : kNothing;
}
