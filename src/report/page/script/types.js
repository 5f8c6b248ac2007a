// The types of the page: what the program writes (`report/page/data.rs`), and the state of the view.

/**
 * The part of a series that an image shows: k of TᵏE, everything beyond K, or the whole image.
 * @typedef {number | 'rest' | 'whole'} Slot
 */

/**
 * A way to solve the scene; `own` is the picture of the reader.
 * @typedef {'terms' | 'path' | 'radiosity' | 'own'} World
 */

/**
 * @typedef {object} Layer
 * @property {string} id
 * @property {World} world
 * @property {Slot} slot
 * @property {number} spp
 * @property {number | null} exponent        exponent of the half floats; none if the means follow from other layers
 * @property {[number, number]} codes lowest logarithm and step of the 8-bit codes
 * @property {string} doubt                  why errors of single pixels cannot be trusted, or nothing
 */

/**
 * One way to solve the scene.
 * @typedef {object} Answer
 * @property {World} world
 * @property {string} label
 * @property {number[][]} mean               by slot and channel
 * @property {number[][][]} deviation        by replicate, slot and channel
 * @property {number | null} t95             half width of a 95 % interval in standard errors
 * @property {'finite' | 'infinite' | 'unknown'} variance
 * @property {number} tiles                  exponent of the tile sums
 * @property {number[]} mesh                 error of the mesh in the image mean, by channel
 */

/**
 * @typedef {object} Curve
 * @property {string} label
 * @property {[World, Slot] | null} of
 * @property {[number, number, number][]} points   x, value, half width of the interval
 */

/**
 * @typedef {object} Plot
 * @property {string} title
 * @property {Curve[]} curves
 * @property {{label: string, x0: number, value: number, ratio: number}[]} lines
 */

/**
 * @typedef {object} Data
 * @property {number} version
 * @property {string} scene
 * @property {string} command
 * @property {number} seed
 * @property {number} spp
 * @property {number} width
 * @property {number} height
 * @property {number} reduced
 * @property {[number, number]} full       size of the images of the run
 * @property {number} max_bounces
 * @property {'each' | 'one'} gain          exposure at the start
 * @property {Layer[]} layers
 * @property {Layer[]} early
 * @property {Answer[]} worlds
 * @property {{max_albedo: number[], rate: (number | null)[], rate_is: string}} bounds
 * @property {Plot | null} decay
 * @property {Plot | null} variance
 * @property {string[]} verdicts
 */

/**
 * What an image shows: a term, the sum of the terms up to k, the rest, or the whole.
 * @typedef {object} Subject
 * @property {World} world
 * @property {'term' | 'sum' | 'rest' | 'whole'} kind
 * @property {number} k
 */

/** @typedef {'value' | 'difference' | 'absolute' | 'relative' | 'z'} Metric */
/** @typedef {'srgb' | 'false' | 'signed'} Look */

/**
 * Everything that the reader has chosen.
 * @typedef {object} State
 * @property {Subject} subject
 * @property {Subject} reference
 * @property {Metric} metric
 * @property {Look} look
 * @property {number} exposure              in powers of two
 * @property {number} offset
 * @property {'each' | 'one' | 'off'} gain  each image has its own gain, all have one, none has
 * @property {number | null} wipe           place of the edge, 0 to 1
 * @property {number[]} scale               s by channel
 * @property {boolean[]} on                 whether a slot is part of the sum
 * @property {number | null} spp            show the first samples only
 * @property {[number, number] | null} pixel
 * @property {[number, number, number, number] | null} tiles   block of tiles: left, top, right, bottom
 * @property {{zoom: number, x: number, y: number} | null} frame   none: the whole image
 */

export {};
