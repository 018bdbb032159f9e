"""Boosted trees of one cause, each of which is offered a few of many columns.

A tree that is offered a twelfth of the columns learns as much as one that is offered all, and takes
a twelfth of the time: what is learned from few cases is limited by these, not by the columns.
scikit-learn's estimator counts histograms of all columns for each tree, whatever share of them a
split may use; so its trees are grown here one by one.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from noise.base.trees import BoostedTrees
from noise.training.trees import as_arrays

_OFFERED = 80
"""Columns that a tree is offered."""

_LEARNING_RATE = 0.05
_LEAVES, _FEWEST_IN_A_LEAF = 14, 8
_RIDGE = 1.0
"""Of the values of leaves, in units of their curvature [-]."""

_BINS = 64
"""Of a column's values, the last being for missing ones."""

_CERTAIN = 6.0
"""Logarithmic odds of a cause that no case has, or all have."""


def grow_cause_trees(
    x: NDArray[np.float32], y: NDArray[np.int64], *, n_rounds: int, seed: int
) -> BoostedTrees:
    """Grow trees of each cause against all that is not it.

    Parameters
    ----------
    x : ndarray of float32, shape (n, n_columns)
        [unit of each column], nothing missing.
    y : ndarray of int, shape (n, n_causes)
        Whether each cause is at work.
    n_rounds, seed : int
        Trees a cause, seed of the draws.

    Returns
    -------
    BoostedTrees
        Their scores are logarithmic odds of each cause.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> y = rng.integers(2, size=(300, 2))
    >>> x = (rng.normal(size=(300, 3)) + 4.0 * y[:, [0, 1, 1]]).astype(np.float32)
    >>> trees = grow_cause_trees(x, y, n_rounds=20, seed=0)
    >>> (trees.scores(np.array([[4.0, 0.0, 0.0], [0.0, 4.0, 4.0]])) > 0.0).tolist()
    [[True, False], [False, True]]
    """
    from joblib import Parallel, delayed
    from sklearn.ensemble._hist_gradient_boosting.binning import _BinMapper

    mapper = _BinMapper(n_bins=_BINS, random_state=seed, n_threads=1)
    binned = np.ascontiguousarray(mapper.fit_transform(x.astype(np.float64)).T)
    # A cause that no case has, or all have, needs no trees.
    met = [k for k in range(y.shape[1]) if 0 < y[:, k].sum() < len(y)]
    grown = Parallel(n_jobs=-1, prefer="threads")(
        delayed(_grow)(binned, mapper, y[:, k], n_rounds, np.random.default_rng([seed, k]))
        for k in met
    )
    base = np.where(y.any(axis=0), _CERTAIN, -_CERTAIN)
    base[met] = [_log_odds(y[:, k]) for k in met]
    return as_arrays([(k, t) for k, trees in zip(met, grown, strict=True) for t in trees], base)


def _grow(
    binned: NDArray[np.uint8],
    mapper: Any,
    y: NDArray[np.int64],
    n_rounds: int,
    rng: np.random.Generator,
) -> list[NDArray[Any]]:
    """Return the nodes of each tree, of columns in rows of `binned`."""
    from sklearn.ensemble._hist_gradient_boosting.grower import TreeGrower

    odds = np.full(y.size, _log_odds(y))
    counts = np.asarray(mapper.n_bins_non_missing_)
    trees = []
    for _ in range(n_rounds):
        chosen = np.sort(rng.permutation(len(binned))[:_OFFERED])
        offered = binned[chosen].T
        p = 1.0 / (1.0 + np.exp(-odds))
        grower = TreeGrower(
            offered,
            (p - y).astype(np.float32),
            (p * (1.0 - p)).astype(np.float32),
            max_leaf_nodes=_LEAVES,
            min_samples_leaf=_FEWEST_IN_A_LEAF,
            n_bins=_BINS,
            n_bins_non_missing=counts[chosen],
            l2_regularization=_RIDGE,
            shrinkage=_LEARNING_RATE,
            n_threads=1,  # sums are the same on every machine
        )
        grower.grow()
        tree = grower.make_predictor([mapper.bin_thresholds_[j] for j in chosen])
        odds += tree.predict_binned(offered, _BINS - 1, 1)
        nodes = tree.nodes.copy()
        nodes["feature_idx"] = chosen[nodes["feature_idx"]]
        trees.append(nodes)
    return trees


def _log_odds(y: NDArray[np.int64]) -> float:
    share = float(y.mean())
    return float(np.log(share / (1.0 - share)))
