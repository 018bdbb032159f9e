"""Boosted trees as plain arrays.

scikit-learn grows the trees; kept are seven arrays, in one NPZ file. Such a file runs no code when
it is opened, loads under any version of scikit-learn (or none) and gives the same bytes of
probabilities everywhere, which a pickle does not. Boosting, because many weak features tell creak
from squawk: a random forest of the same samples errs a sixth more often.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["Trees", "as_arrays", "grow_trees"]

_LEAF = -1


@dataclass(frozen=True, eq=False)
class Trees:
    """Decision trees, their nodes one after the other.

    Parameters
    ----------
    roots : ndarray of int32, shape (n_trees,)
        First node of each tree.
    classes : ndarray of int16, shape (n_trees,)
        Class whose score a tree adds to.
    feature : ndarray of int16, shape (n_nodes,)
        Feature that a node looks at; -1 in a leaf.
    threshold : ndarray of float64, shape (n_nodes,)
        Up to it the way goes left.
    children : ndarray of int32, shape (n_nodes, 2)
        Left and right child.
    missing_left : ndarray of bool, shape (n_nodes,)
        Whether NaN goes left.
    value : ndarray of float64, shape (n_nodes,)
        What a leaf adds.
    base : ndarray of float64, shape (n_classes,)
        Scores before any tree.
    """

    roots: NDArray[np.int32]
    classes: NDArray[np.int16]
    feature: NDArray[np.int16]
    threshold: NDArray[np.float64]
    children: NDArray[np.int32]
    missing_left: NDArray[np.bool_]
    value: NDArray[np.float64]
    base: NDArray[np.float64]

    def check(self) -> None:
        """Raise ValueError unless every way through the trees ends in a leaf."""
        n = len(self.feature)
        lengths = {len(a) for a in (self.threshold, self.children, self.missing_left, self.value)}
        shapes = self.children.shape[1:] == (2,) and self.classes.shape == self.roots.shape
        if lengths != {n} or not shapes or not len(self.roots):
            raise ValueError("its arrays do not fit together")
        inner = np.flatnonzero(self.feature != _LEAF)
        descends = (self.children[inner] > inner[:, None]) & (self.children[inner] < n)
        if not (descends.all() and (self.roots >= 0).all() and (self.roots < n).all()):
            raise ValueError("its trees do not end")
        if (self.classes < 0).any() or (self.classes >= self.base.size).any():
            raise ValueError("its trees speak for classes that there are not")

    def scores(self, x: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Sum of what the trees of each class say.

        Parameters
        ----------
        x : ndarray, shape (n, n_features)
            NaN where a feature is missing.

        Returns
        -------
        ndarray, shape (n, n_classes)
        """
        scores = np.tile(self.base.astype(np.float64), (len(x), 1))
        _add_up(
            np.ascontiguousarray(x, dtype=np.float64),
            self.roots,
            self.classes,
            self.feature,
            self.threshold,
            self.children,
            self.missing_left,
            self.value,
            scores,
        )
        return scores

    def probabilities(self, x: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Probabilities of the classes, not calibrated; arguments as of `scores`."""
        scores = self.scores(x)
        p = np.exp(scores - scores.max(axis=1, keepdims=True))
        return np.asarray(p / p.sum(axis=1, keepdims=True))


def grow_trees(
    x: NDArray[np.floating[Any]],
    y: NDArray[np.int64],
    *,
    weight: NDArray[np.float64],
    n_rounds: int,
    seed: int,
) -> Trees:
    """Grow trees.

    Parameters
    ----------
    x : ndarray, shape (n, n_features)
        NaN where a feature is missing.
    y : ndarray of int, shape (n,)
        Classes 0, 1, 2 ..., three or more.
    weight : ndarray, shape (n,)
        How much each sample counts.
    n_rounds, seed : int
        Trees a class, seed of the draws.

    Returns
    -------
    Trees

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> y = np.repeat([0, 1, 2], 100)
    >>> trees = grow_trees(rng.normal(size=(300, 2)) + 4.0 * y[:, None], y, weight=np.ones(300),
    ...                    n_rounds=10, seed=0)
    >>> trees.probabilities(np.array([[0.0, 0.0], [8.0, np.nan]])).argmax(axis=1).tolist()
    [0, 2]
    """
    from sklearn.ensemble import HistGradientBoostingClassifier
    from threadpoolctl import threadpool_limits

    # Shallow trees that see a third of the features each: what is learned from made-up sound has to
    # hold for other sound.
    model = HistGradientBoostingClassifier(
        max_iter=n_rounds,
        learning_rate=0.1,
        max_leaf_nodes=16,
        min_samples_leaf=10,
        l2_regularization=1.0,
        max_features=0.3,
        early_stopping=False,
        random_state=seed,
    )
    with threadpool_limits(1):  # sums are the same on every machine
        model.fit(x, y, sample_weight=weight)
    return as_arrays([model])


@njit(cache=True, error_model="numpy")
def _add_up(x, roots, classes, feature, threshold, children, missing_left, value, scores):
    for i in range(x.shape[0]):
        for tree in range(len(roots)):
            node = roots[tree]
            while feature[node] >= 0:
                v = x[i, feature[node]]
                left = missing_left[node] if np.isnan(v) else v <= threshold[node]
                node = children[node, 0] if left else children[node, 1]
            scores[i, classes[tree]] += value[node]


def as_arrays(models: Sequence[Any]) -> Trees:
    """Return scikit-learn's boosted trees as arrays; of several models the classes follow on."""
    grown, first = [], 0
    for model in models:
        for trees in model._predictors:
            grown += [(first + k, tree.nodes) for k, tree in enumerate(trees)]
        first += len(model._predictors[0])
    bases = [np.asarray(model._baseline_prediction).reshape(-1) for model in models]
    nodes = np.concatenate([tree for _, tree in grown])
    counts = np.array([len(tree) for _, tree in grown])
    roots = np.cumsum(counts) - counts
    leaf = nodes["is_leaf"].astype(bool)
    children = np.stack([nodes["left"], nodes["right"]], axis=1) + np.repeat(roots, counts)[:, None]
    return Trees(
        roots=roots.astype(np.int32),
        classes=np.array([k for k, _ in grown], dtype=np.int16),
        feature=np.where(leaf, _LEAF, nodes["feature_idx"]).astype(np.int16),
        threshold=np.where(leaf, 0.0, nodes["num_threshold"]).astype(np.float64),
        children=np.where(leaf[:, None], 0, children).astype(np.int32),
        missing_left=nodes["missing_go_to_left"].astype(bool),
        value=np.where(leaf, nodes["value"], 0.0).astype(np.float64),
        base=np.concatenate(bases).astype(np.float64),
    )
