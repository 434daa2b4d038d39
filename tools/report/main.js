// The order in which the page comes up: texts first, then pictures, then what moves them.
import {startControls, startTheme} from './controls.js';
import {byId} from './formats.js';
import {entries} from './state.js';
import {startTables} from './tables.js';
import {startViews} from './views.js';

startTheme();
startTables();
if (entries.length) {
    startViews();
    startControls();
} else
    byId('viewer').remove();
document.documentElement.dataset.ready = 'yes';
