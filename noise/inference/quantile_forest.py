"""A quantile regression forest as plain arrays.

A forest's leaf holds the training values that came to it; those of all trees together are the
distribution of what is asked for, given the features (N. Meinshausen, *Quantile Regression
Forests*, Journal of Machine Learning Research 7, 2006, 983-999). Here a leaf keeps a few order
statistics of its values in place of all of them, so that the file stays small; it runs no code when
it is opened, and depends on no version of scikit-learn, which only grows the trees.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["PER_LEAF", "QuantileForest", "grow_quantile_forest"]

PER_LEAF = 8
"""Values that a leaf keeps: the middles of as many equal shares."""

_FEATURES_A_SPLIT = 0.8
"""Share of the features that a split is sought among; many of them are missing at any one."""

_LEAF = -1


@dataclass(frozen=True, eq=False)
class QuantileForest:
    """Regression trees, their nodes one after the other; the left child is the next node.

    Parameters
    ----------
    roots : ndarray of int32, shape (n_trees,)
        First node of each tree.
    feature : ndarray of int16, shape (n_nodes,)
        Feature that a node looks at; -1 in a leaf.
    threshold : ndarray of float32, shape (n_nodes,)
        Up to it the way goes left.
    following : ndarray of int32, shape (n_nodes,)
        Right child; in a leaf its row of `values`.
    missing_left : ndarray of bool, shape (n_nodes,)
        Whether NaN goes left.
    values : ndarray of float16, shape (n_leaves, PER_LEAF)
        What the leaves keep.
    """

    roots: NDArray[np.int32]
    feature: NDArray[np.int16]
    threshold: NDArray[np.float32]
    following: NDArray[np.int32]
    missing_left: NDArray[np.bool_]
    values: NDArray[np.float16]

    def check(self, n_features: int) -> None:
        """Raise ValueError unless every way through the trees ends in a leaf."""
        n = len(self.feature)
        if {len(a) for a in (self.threshold, self.following, self.missing_left)} != {n}:
            raise ValueError("its arrays do not fit together")
        if self.values.ndim != 2 or not len(self.roots):
            raise ValueError("its trees hold no values")
        inner = np.flatnonzero(self.feature != _LEAF)
        descends = (self.following[inner] > inner + 1) & (self.following[inner] < n)
        leaf_rows = self.following[self.feature == _LEAF]
        rows_exist = (leaf_rows >= 0) & (leaf_rows < len(self.values))
        starts = (self.roots >= 0) & (self.roots < n)
        if not (descends.all() and rows_exist.all() and starts.all()):
            raise ValueError("its trees do not end")
        if int(self.feature.max()) >= n_features or not np.isfinite(self.values).all():
            raise ValueError("its trees ask for features that it does not name")

    def pooled(self, x: NDArray[np.float64]) -> NDArray[np.float32]:
        """Values of the leaves that samples come to, in rising order.

        Parameters
        ----------
        x : ndarray, shape (n, n_features)
            NaN where a feature is missing.

        Returns
        -------
        ndarray, shape (n, n_trees * PER_LEAF)
        """
        # As scikit-learn does, features are compared in single precision.
        x32 = np.asarray(x, dtype=np.float32)
        rows = np.arange(len(x32))[:, None]
        node = np.broadcast_to(self.roots, (len(x32), self.roots.size)).copy()
        while True:
            feature = self.feature[node]
            inner = feature != _LEAF
            if not inner.any():
                break
            value = x32[rows, np.where(inner, feature, 0)]
            left = np.where(np.isnan(value), self.missing_left[node], value <= self.threshold[node])
            node = np.where(inner, np.where(left, node + 1, self.following[node]), node)
        values = self.values[self.following[node]].astype(np.float32)
        return np.sort(values.reshape(len(x32), -1), axis=1)


def grow_quantile_forest(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    *,
    n_trees: int,
    least_leaf: int,
    share: float,
    seed: int,
) -> QuantileForest:
    """Grow a quantile forest.

    Parameters
    ----------
    x : ndarray, shape (n, n_features)
        NaN where a feature is missing.
    y : ndarray, shape (n,)
        What is asked for.
    n_trees, least_leaf : int
        Number of trees, samples in the smallest leaf.
    share : float
        Of the samples that a tree is grown on; its leaves then take in all of them.
    seed : int

    Returns
    -------
    QuantileForest

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> x = rng.uniform(0.0, 1.0, (2000, 1))
    >>> forest = grow_quantile_forest(x, x[:, 0] + 0.1 * rng.normal(size=2000), n_trees=20,
    ...                               least_leaf=20, share=0.5, seed=0)
    >>> low, high = np.quantile(forest.pooled(np.array([[0.5]])), [0.05, 0.95])
    >>> bool(0.25 < low < 0.4 and 0.6 < high < 0.75)
    True
    """
    from sklearn.ensemble import RandomForestRegressor

    model = RandomForestRegressor(
        n_estimators=n_trees,
        min_samples_leaf=least_leaf,
        max_samples=share,
        max_features=_FEATURES_A_SPLIT,
        random_state=seed,
        n_jobs=-1,
    ).fit(x, y)
    arrivals = model.apply(x)
    trees = [
        _as_arrays(estimator.tree_, arrivals[:, index], y)
        for index, estimator in enumerate(model.estimators_)
    ]
    nodes = np.cumsum([0, *(len(tree.feature) for tree in trees)])
    leaves = np.cumsum([0, *(len(tree.values) for tree in trees)])
    return QuantileForest(
        roots=nodes[:-1].astype(np.int32),
        feature=np.concatenate([tree.feature for tree in trees]),
        threshold=np.concatenate([tree.threshold for tree in trees]),
        following=np.concatenate(
            [
                tree.following + np.where(tree.feature == _LEAF, leaf, node).astype(np.int32)
                for tree, node, leaf in zip(trees, nodes[:-1], leaves[:-1], strict=True)
            ]
        ),
        missing_left=np.concatenate([tree.missing_left for tree in trees]),
        values=np.concatenate([tree.values for tree in trees]),
    )


def _as_arrays(tree: Any, arrivals: NDArray[np.int64], y: NDArray[np.float64]) -> QuantileForest:
    """Return one tree, whose nodes scikit-learn keeps in depth-first order, the left one first."""
    leaf = tree.children_left < 0
    rows = np.cumsum(leaf) - 1
    quantiles = (np.arange(PER_LEAF) + 0.5) / PER_LEAF
    order = np.argsort(arrivals, kind="stable")
    reached, starts = np.unique(arrivals[order], return_index=True)
    values = np.zeros((int(leaf.sum()), PER_LEAF), dtype=np.float16)
    for node, of_node in zip(reached, np.split(y[order], starts[1:]), strict=True):
        values[rows[node]] = np.quantile(of_node, quantiles, method="nearest")
    return QuantileForest(
        roots=np.zeros(1, dtype=np.int32),
        feature=np.where(leaf, _LEAF, tree.feature).astype(np.int16),
        threshold=_at_most(np.where(leaf, 0.0, tree.threshold)),
        following=np.where(leaf, rows, tree.children_right).astype(np.int32),
        missing_left=np.asarray(tree.missing_go_to_left, dtype=bool) & ~leaf,
        values=values,
    )


def _at_most(threshold: NDArray[np.float64]) -> NDArray[np.float32]:
    """Round down to single precision, so that no single-precision feature changes sides."""
    rounded = threshold.astype(np.float32)
    return np.where(rounded > threshold, np.nextafter(rounded, np.float32(-np.inf)), rounded)
