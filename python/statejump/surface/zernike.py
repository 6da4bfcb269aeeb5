# SPDX-License-Identifier: GPL-3.0-or-later
"""Zernike's circle polynomials in the order and normalization of R. J. Noll, J. Opt. Soc. Am. 66, 207 (1976).

Term 1 is 1. Over the unit circle every term has the RMS 1, and the mean product of two different terms is 0. Even terms
contain cos mθ, odd ones sin mθ; θ runs from the first lateral axis to the second.
"""
from __future__ import annotations

from math import factorial, sqrt

import numpy as np

from statejump.core.errors import NotAllowed, StatejumpError

MOST = 36
ORDERS = tuple(n * (n + 1) // 2 for n in range(1, 9))  # 1, 3, 6, ... 36: number of all terms of degree below n
# Terms are undetermined if their singular value, with columns scaled to length 1, is below this.
LEAST_SINGULAR_VALUE = 1e-6


def noll(term: int) -> tuple[int, int]:
    """Return degree n and order m of a Zernike term. Terms are counted from 1. A negative order means a term with sin.

    :raises StatejumpError: there is no such term
    """
    if not isinstance(term, int) or term < 1:
        raise NotAllowed("term", term, code="not_positive_integer")
    degree = 0
    while (degree + 1) * (degree + 2) // 2 < term:
        degree += 1
    place = term - degree * (degree + 1) // 2 - 1
    order = 2 * ((place + 1) // 2) if degree % 2 == 0 else 2 * (place // 2) + 1
    return degree, order if term % 2 == 0 or order == 0 else -order


def zernike(term: int, points: np.ndarray) -> np.ndarray:
    """Return a term at points of the unit circle (n, 2)."""
    degree, signed = noll(term)
    order = abs(signed)
    radius, angle = np.hypot(points[:, 0], points[:, 1]), np.arctan2(points[:, 1], points[:, 0])
    radial = np.zeros(len(points))
    for k in range((degree - order) // 2 + 1):
        factor = (-1) ** k * factorial(degree - k) // (
            factorial(k) * factorial((degree + order) // 2 - k) * factorial((degree - order) // 2 - k))
        radial += factor * radius ** (degree - 2 * k)
    if order == 0:
        return sqrt(degree + 1) * radial
    around = np.cos(order * angle) if signed > 0 else np.sin(order * angle)
    found: np.ndarray = sqrt(2 * (degree + 1)) * radial * around
    return found


def fitted(points: np.ndarray, values: np.ndarray, terms: int | None = None) -> np.ndarray:
    """Return the coefficients of Zernike terms 1 to ``terms``, by least squares over points of the unit circle.

    :param terms: number of terms; None: as many whole orders as the points determine
    :raises StatejumpError: the points determine fewer terms
    """
    if terms is not None and not (isinstance(terms, int) and 1 <= terms <= MOST):
        raise NotAllowed("terms", terms, code="terms_out_of_range", most=MOST)
    most = MOST if terms is None else terms
    matrix = np.stack([zernike(term, points) for term in range(1, most + 1)], axis=1)
    lengths = np.linalg.norm(matrix, axis=0)
    for count in ([most] if terms is not None else reversed(ORDERS)):
        part = matrix[:, :count]
        if count <= len(points) and (lengths[:count] > 0).all() and np.linalg.svd(
                part / lengths[:count], compute_uv=False)[-1] > LEAST_SINGULAR_VALUE:
            return np.asarray(np.linalg.lstsq(part, values, rcond=None)[0])
    raise StatejumpError(code="zernike_undetermined", count=len(points), terms=most)
